// SPDX-License-Identifier: MIT
#include "common/transport/first_bytes.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string_view>

#include "common/transport/framing.hpp"
#include "common/transport/tls.hpp"

namespace hapticast {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::optional<ConnectionKind> decide(const Bytes& bytes) { return FirstBytes(true).add(bytes); }

Bytes toBytes(std::string_view text) { return {text.begin(), text.end()}; }

TEST(FirstBytes, DecideWhatAConnectionCarries) {
  TlsEngine client(TlsContext::ofPinningClient(), "server", nullptr);
  EXPECT_EQ(decide(client.output()), ConnectionKind::kTls);
  EXPECT_EQ(decide(toBytes("GET / HTTP/1.1")), ConnectionKind::kHttp);
  EXPECT_EQ(decide(toBytes("GET /")), ConnectionKind::kHttp);
  for (const char* request : {"HEAD / HTTP/1.1", "POST / HTTP/1.1", "PUT /", "OPTIONS *", "get /"})
    EXPECT_EQ(decide(toBytes(request)), ConnectionKind::kHttp) << request;
  for (const char* other : {"SSH-2.0", "GE T", "\x16\x02\x01\x01"})
    EXPECT_EQ(decide(toBytes(other)), ConnectionKind::kMessages) << other;
}

TEST(FirstBytes, ALengthOfASmallMessageIsNoOtherKind) {
  for (std::size_t size = 1; size <= kMaxSmallMessageBytes; ++size) {
    const LengthPrefix prefix = lengthPrefix(size);
    ASSERT_EQ(decide({prefix.begin(), prefix.end()}), ConnectionKind::kMessages) << size;
  }
}

TEST(FirstBytes, DecideTheSameHoweverTheyArrive) {
  std::mt19937 random(48);
  for (int round = 0; round < 500; ++round) {
    Bytes bytes = round % 3 == 0   ? toBytes("GET /health")
                  : round % 3 == 1 ? Bytes{22, 3, 1, 2, 0, 1}
                                   : Bytes(4 + random() % 20, std::uint8_t{5});
    const auto expected = decide(bytes);
    FirstBytes first(true);
    std::optional<ConnectionKind> kind;
    std::size_t used = 0;
    while (!kind) {
      ASSERT_TRUE(first.undecided());
      const std::size_t size = std::min<std::size_t>(random() % 3, bytes.size() - used);
      kind = first.add(std::span(bytes).subspan(used, size));
      used += size;
      EXPECT_EQ(kind.has_value(), used >= FirstBytes::kNeededBytes);
    }
    EXPECT_EQ(kind, expected);
    EXPECT_FALSE(first.undecided());
    bytes.resize(used);
    EXPECT_EQ(first.pop(), bytes) << "nothing is lost";
  }
}

}  // namespace
}  // namespace hapticast
