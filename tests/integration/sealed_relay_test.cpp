// SPDX-License-Identifier: MIT
// Sealed datagrams from an origin over a real nats-server to the viewers of an edge. The viewer's
// control connection is a channel in memory that passes for TLS; the key travels only if NATS has
// TLS.
#include <atomic>
#include <thread>

#include "server/relay/relay_publisher.hpp"
#include "server/relay/relay_subscriber.hpp"
#include "tests/integration/datagram_fixture.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/memory_channel.hpp"
#include "tests/support/nats_server.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::testing {
namespace {

using namespace std::chrono_literals;

/// An origin whose frames the test makes.
struct SealingOrigin {
  SealingOrigin(const server::NatsAddress& address, const server::NatsCredentials& credentials)
      : signer(SigningKey(), std::make_unique<server::DatagramSealer>(clock)),
        publisher(address, credentials, clock, media, signer, {}) {
    publisher.describe(TestServer::description());
  }
  void publish(std::uint64_t id) {
    HapticFrame frame;
    frame.epoch = 3;
    frame.id = id;
    frame.media_time = media.now();
    frame.objects.push_back({1, 0, id, flatRelief({0, 0, 40, 40}), {}, nullptr, {}, {}});
    if (const auto key = signer.rotateKey()) publisher.changeKey(*key);
    publisher.publish(encoder.encode(frame, {}, &signer, publisher.datagramsWanted()));
  }

  SteadyClock clock;
  LocalMediaClock media{clock};
  server::FrameSigner signer;
  server::FrameEncoder encoder;
  server::RelayPublisher publisher;
};

/// An edge with viewers of its own.
struct SealedEdge {
  SealedEdge(asio::io_context& io, const Clock& clock, const server::NatsAddress& address,
             const server::NatsCredentials& credentials)
      : media(steady),
        broadcaster(io, clock, media, {}, {}),
        listener(io, {"127.0.0.1", 0}, broadcaster),
        sender(io, clock, listener.endpoint(), {}),
        subscriber(address, credentials, {}, steady, media, broadcaster) {
    broadcaster.enableUdp(sender);
    listener.start();
    polling = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        subscriber.poll();
        if (subscriber.description()) synchronised = true;
      }
    });
  }

  SteadyClock steady;
  server::RelayClock media;
  server::Broadcaster broadcaster;
  server::Listener listener;
  server::DatagramSender sender;
  server::RelaySubscriber subscriber;
  std::atomic<bool> synchronised{false};
  std::jthread polling;
};

class SealedRelayTest : public StreamTest {
 protected:
  void SetUp() override {
    if (!NatsServer::exists()) GTEST_SKIP() << "nats-server is not installed";
  }
  /// Starts NATS, with TLS or without, then the origin and the edge.
  void start(bool tls) {
    const std::string certificate = folder / "cert.pem", key = folder / "key.pem";
    std::string settings;
    if (tls) {
      const std::string command =
          "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj "
          "/CN=localhost -addext subjectAltName=IP:127.0.0.1 -keyout " +
          key + " -out " + certificate + " 2>/dev/null";
      ASSERT_EQ(std::system(command.c_str()), 0);
      settings = "tls { cert_file: \"" + certificate + "\", key_file: \"" + key + "\" }\n";
      credentials.ca_file = certificate;
    }
    nats = std::make_unique<NatsServer>(folder.string(), settings);
    const auto address = server::parseNatsAddress(nats->channel("lab"));
    ASSERT_TRUE(address);
    origin = std::make_unique<SealingOrigin>(*address, credentials);
    edge = std::make_unique<SealedEdge>(io, clock, *address, credentials);
    ASSERT_TRUE(runUntil([&] { return edge->synchronised.load(); }));
    client = std::make_unique<TestClient>(
        io, clock, 0, [this](client::ConnectionSettings& s) { s.dial = dialByTls(); });
  }
  client::Dial dialByTls() {
    return [this](asio::io_context&, const Endpoint&, Duration,
                  client::DialCancellation&) -> asio::awaitable<client::Dialled> {
      auto [ours, theirs] = MemoryChannel::pair(io, kMaxSmallMessageBytes);
      const auto host = asio::ip::make_address("127.0.0.1");
      ours->pretendTls({host, host}, "127.0.0.1:" + std::to_string(edge->listener.address().port));
      theirs->pretendTls({host, host}, "127.0.0.1:1");
      edge->broadcaster.accept(std::move(theirs));
      co_return std::move(ours);
    };
  }
  /// A frame about every 20 ms, until `done`.
  bool streamUntil(const std::function<bool()>& done) {
    auto next = clock.now();
    return runUntil([&] {
      if (clock.now() >= next) {
        origin->publish(++id_);
        next += 20ms;
      }
      client->drain();
      return done();
    });
  }
  bool streamOn(std::size_t frames) {
    const std::size_t enough = client->frames.size() + frames;
    return streamUntil([&] { return client->frames.size() >= enough; });
  }
  [[nodiscard]] bool byUdp() const {
    return client->connection.delivery().transport == client::Transport::kDatagrams;
  }

  TempFolder folder;
  server::NatsCredentials credentials;
  std::unique_ptr<NatsServer> nats;
  std::unique_ptr<SealingOrigin> origin;
  std::unique_ptr<SealedEdge> edge;
  std::unique_ptr<TestClient> client;

 private:
  std::uint64_t id_ = 0;
};

TEST_F(SealedRelayTest, OverTlsAnEdgesViewersReceiveTheKeyAndTheBodiesUnopened) {
  ASSERT_NO_FATAL_FAILURE(start(true));
  ASSERT_TRUE(streamUntil([&] { return byUdp(); }));
  ASSERT_TRUE(streamOn(20));
  for (int i = 0; i < 2; ++i) {
    origin->signer.revokeKey();
    ASSERT_TRUE(streamOn(20));
  }
  EXPECT_TRUE(byUdp());
  EXPECT_GT(client->connection.datagrams().received, 20U);
  RawPeer plain(io, edge->listener.address().port);
  plain.send(Hello{kProtocolVersion, "raw", false, true});
  ASSERT_TRUE(receives<Welcome>(plain));
  EXPECT_EQ(plain.all<Welcome>()[0].datagram_token, 0U) << "without TLS";
  EXPECT_FALSE(plain.all<Welcome>()[0].datagram_key);
}

TEST_F(SealedRelayTest, WithoutTlsToNatsFramesReachTheViewersByTcpOnly) {
  const LogLines lines;
  ASSERT_NO_FATAL_FAILURE(start(false));
  ASSERT_TRUE(streamOn(40));
  EXPECT_FALSE(byUdp());
  EXPECT_FALSE(origin->publisher.datagramsWanted());
  EXPECT_EQ(edge->sender.counts().viewers.sent, 0U);
  EXPECT_TRUE(client->lost.empty());
  client.reset();
  edge.reset();
  origin.reset();  // its threads log no more lines
  const std::string warning = "warning --publish: viewers of edges receive frames by TCP only";
  EXPECT_NE(lines.text().find(warning), std::string::npos);
}

}  // namespace
}  // namespace hapticast::testing
