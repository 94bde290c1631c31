// SPDX-License-Identifier: MIT
// TLS between two engines in memory: bytes in pieces of any size, fingerprints, wrong bytes.
#include "common/transport/tls.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "common/transport/framing.hpp"

namespace hapticast {
namespace {

using Bytes = std::vector<std::uint8_t>;

TlsContext makeServer(const TlsIdentity& identity) {
  auto context = TlsContext::ofServer(identity);
  EXPECT_TRUE(context.ok());
  return std::move(context).value();
}

/// A client and a server, with the bytes that they have received.
struct TlsPair {
  explicit TlsPair(FingerprintCheck check = nullptr, std::size_t piece_bytes = 1 << 20)
      : context(makeServer(makeTlsIdentity())),
        server(context),
        client(TlsContext::ofPinningClient(), "server", std::move(check)),
        piece(piece_bytes) {}

  /// Delivers bytes both ways until none wait, or an end fails. Returns the first error.
  std::string deliver() {
    while (!client.output().empty() || !server.output().empty()) {
      if (std::string error = move(client, server, at_server); !error.empty()) return error;
      if (std::string error = move(server, client, at_client); !error.empty()) return error;
    }
    return "";
  }
  std::string move(TlsEngine& from, TlsEngine& to, Bytes& received) const {
    const Bytes bytes = std::exchange(from.output(), {});
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      const auto part = std::span(bytes).subspan(at, std::min(piece, bytes.size() - at));
      if (const auto error = to.receive(part, received)) return error->message;
    }
    return "";
  }

  TlsContext context;
  TlsEngine server;
  TlsEngine client;
  std::size_t piece;
  Bytes at_server;
  Bytes at_client;
};

Bytes countTo(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

TEST(Tls, CarriesBytesBothWaysInPiecesOfAnySize) {
  for (const std::size_t piece : {1U, 7U, 1000U, 1U << 20U}) {
    TlsPair pair(nullptr, piece);
    ASSERT_EQ(pair.deliver(), "");
    ASSERT_TRUE(pair.client.established() && pair.server.established());
    const Bytes small = countTo(20);
    const Bytes large = countTo(100'000);
    EXPECT_TRUE(pair.client.send({}, small));
    EXPECT_TRUE(pair.server.send({}, large));
    EXPECT_NE(pair.client.output(), small) << "encrypted";
    ASSERT_EQ(pair.deliver(), "");
    EXPECT_EQ(pair.at_server, small);
    EXPECT_EQ(pair.at_client, large);
    pair.client.finish();
    ASSERT_EQ(pair.deliver(), "");
    EXPECT_TRUE(pair.server.ended());
  }
}

TEST(Tls, SendsNothingBeforeTheHandshake) {
  TlsPair pair;
  EXPECT_FALSE(pair.server.send({}, countTo(3)));
  EXPECT_FALSE(pair.client.send({}, countTo(3)));
  EXPECT_TRUE(pair.server.output().empty());
}

TEST(Tls, TheClientChecksTheFingerprintOfTheServersKey) {
  std::optional<Fingerprint> shown;
  TlsPair accepted([&](const Fingerprint& key) -> std::optional<std::string> {
    shown = key;
    return std::nullopt;
  });
  ASSERT_EQ(accepted.deliver(), "");
  EXPECT_EQ(shown, accepted.context.fingerprint());
  TlsPair refused([](const Fingerprint&) { return std::optional<std::string>("another key"); });
  EXPECT_EQ(refused.deliver(), "another key");
  EXPECT_TRUE(refused.client.untrusted());
  EXPECT_FALSE(refused.client.established());
  EXPECT_FALSE(refused.client.send({}, countTo(3))) << "nothing for a server without trust";
}

TEST(Tls, AnAuthorityIsNeededWhereTheClientNamesOne) {
  const TlsContext server = makeServer(makeTlsIdentity());
  auto trusting = TlsContext::ofClient(makeTlsIdentity().certificate_pem);
  ASSERT_TRUE(trusting.ok());
  TlsPair pair;
  pair.client = TlsEngine(trusting.value(), "server", nullptr);
  const std::string error = pair.deliver();
  EXPECT_NE(error.find("the server's certificate is not valid"), std::string::npos) << error;
  EXPECT_TRUE(pair.client.untrusted());
}

TEST(Tls, TextsThatAreNoCertificateOrKeyAreErrors) {
  const TlsIdentity one = makeTlsIdentity();
  const TlsIdentity other = makeTlsIdentity();
  const auto problem = [](const TlsIdentity& identity) {
    const auto context = TlsContext::ofServer(identity);
    return context.ok() ? "" : context.error().message;
  };
  EXPECT_EQ(problem(one), "");
  EXPECT_EQ(problem({"x", one.key_pem}), "holds no certificate in PEM");
  EXPECT_EQ(problem({one.certificate_pem, "x"}), "holds no private key in PEM without a password");
  EXPECT_EQ(problem({one.certificate_pem, other.key_pem}),
            "is not the private key of the certificate");
  EXPECT_FALSE(TlsContext::ofClient("x").ok());
}

TEST(Tls, ADamagedByteEndsTheConnection) {
  std::mt19937 random(5);
  for (int run = 0; run < 200; ++run) {
    TlsPair pair;
    ASSERT_EQ(pair.deliver(), "");
    ASSERT_TRUE(pair.client.send({}, countTo(50)));
    Bytes& bytes = pair.client.output();
    bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
    (void)pair.deliver();
    EXPECT_TRUE(pair.at_server.empty()) << "a changed record has no bytes";
  }
}

TEST(Tls, NoisePutsNeitherEndOutOfOrder) {
  std::mt19937 random(6);
  for (int run = 0; run < 200; ++run) {
    TlsPair pair;
    Bytes noise(random() % 300);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
    if (!noise.empty() && run % 2 == 0) noise[0] = 22;
    (void)pair.server.receive(noise, pair.at_server);
    (void)pair.client.receive(noise, pair.at_client);
    EXPECT_TRUE(pair.at_server.empty() && pair.at_client.empty());
    EXPECT_LT(pair.server.output().size(), 10'000U);
  }
}

// A prefix and a payload of any size arrive as one message, in as few records as TLS allows.
TEST(Tls, SendsAPrefixAndAPayloadInFullRecords) {
  constexpr std::size_t kRecord = 16384, kOverhead = 22;  // RFC 8446, section 5.2
  for (const std::size_t size :
       {0U, 1U, 2200U, 16379U, 16380U, 16381U, 20'000U, 32'764U, 70'000U}) {
    TlsPair pair;
    ASSERT_EQ(pair.deliver(), "");
    const Bytes prefix{9, 8, 7, 6};
    const Bytes payload = countTo(size);
    ASSERT_TRUE(pair.server.send(prefix, payload));
    const std::size_t all = prefix.size() + size, records = (all + kRecord - 1) / kRecord;
    EXPECT_EQ(pair.server.output().size(), all + kOverhead * records) << size;
    ASSERT_EQ(pair.deliver(), "");
    Bytes expected = prefix;
    expected.insert(expected.end(), payload.begin(), payload.end());
    EXPECT_EQ(pair.at_client, expected) << size;
  }
}

}  // namespace
}  // namespace hapticast
