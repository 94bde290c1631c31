// SPDX-License-Identifier: MIT
// Sealed datagrams from the server to the client, over real sockets. The control connection is a
// channel in memory that passes for TLS.
#include "tests/integration/datagram_fixture.hpp"
#include "tests/support/memory_channel.hpp"

namespace hapticast::testing {
namespace {

using namespace std::chrono_literals;
using client::Transport;

class SealedDatagramsTest : public StreamTest {
 protected:
  /// What a client dials with to reach `server` by TLS.
  std::function<void(client::ConnectionSettings&)> byTls(DatagramServer& server) {
    return [this, &server](client::ConnectionSettings& settings) {
      settings.dial = [this, &server](
                          asio::io_context&, const Endpoint&, Duration,
                          client::DialCancellation&) -> asio::awaitable<client::Dialled> {
        auto [ours, theirs] = MemoryChannel::pair(io, kMaxSmallMessageBytes);
        const auto host = asio::ip::make_address("127.0.0.1");
        ours->pretendTls({host, host}, "127.0.0.1:" + std::to_string(server.port()));
        theirs->pretendTls({host, host}, "127.0.0.1:1");
        server.broadcaster.accept(std::move(theirs));
        co_return std::move(ours);
      };
    };
  }
  /// A frame about every 20 ms, until `done`.
  bool streamUntil(DatagramServer& server, TestClient& client, const std::function<bool()>& done) {
    auto next = clock.now();
    return runUntil([&] {
      if (clock.now() >= next) {
        server.publish(++id_, 40);
        next += 20ms;
      }
      client.drain();
      return done();
    });
  }
  bool streamByUdp(DatagramServer& server, TestClient& client) {
    return streamUntil(server, client, [&] {
      return client.connection.delivery().transport == Transport::kDatagrams;
    });
  }
  bool streamOn(DatagramServer& server, TestClient& client, std::size_t frames) {
    const std::size_t enough = client.frames.size() + frames;
    return streamUntil(server, client, [&] { return client.frames.size() >= enough; });
  }
  /// That the client receives all by UDP, and drops nothing.
  static void expectAllOpened(const TestClient& client) {
    EXPECT_EQ(client.connection.delivery().transport, Transport::kDatagrams);
    EXPECT_EQ(client.connection.datagrams().not_opened, 0U);
    EXPECT_EQ(client.receiver.counts().lost, 0U);
    EXPECT_EQ(client.receiver.counts().slices_lost, 0U);
    EXPECT_TRUE(client.lost.empty());
  }

 private:
  std::uint64_t id_ = 0;
};

/// A server that seals its datagrams.
struct SealingServer : DatagramServer {
  SealingServer(asio::io_context& io, const Clock& clock)
      : DatagramServer(io, clock, std::nullopt, "127.0.0.1", true) {}
};

TEST_F(SealedDatagramsTest, AViewerWithTlsReceivesFramesByUdp) {
  SealingServer server(io, clock);
  TestClient client(io, clock, 0, byTls(server));
  ASSERT_TRUE(streamByUdp(server, client));
  ASSERT_TRUE(streamOn(server, client, 20));
  const std::uint64_t sent = server.broadcaster.counts().sent.frames_sent;
  ASSERT_TRUE(streamOn(server, client, 20));
  EXPECT_EQ(server.broadcaster.counts().sent.frames_sent, sent) << "over TCP";
  EXPECT_TRUE(client.last_has_field);
  EXPECT_TRUE(client.news.empty());
  expectAllOpened(client);
}

TEST_F(SealedDatagramsTest, AViewerWithoutTlsReceivesNoKeyAndNoDatagram) {
  SealingServer server(io, clock);
  const auto peer = viewer(server);
  const Welcome welcome = peer->all<Welcome>().at(0);
  EXPECT_EQ(welcome.datagram_token, 0U);
  EXPECT_FALSE(welcome.datagram_key);
  EXPECT_FALSE(welcome.group);
  EXPECT_TRUE(welcome.verifying_key) << "its frames are signed";
  TestClient client(io, clock, server.port());
  ASSERT_TRUE(streamOn(server, client, 20));
  server.signer.revokeKey();
  ASSERT_TRUE(streamOn(server, client, 20));
  EXPECT_EQ(client.connection.delivery().transport, Transport::kTcp);
  EXPECT_EQ(server.sender->counts().viewers.sent, 0U);
  EXPECT_FALSE(server.broadcaster.datagramsWanted());
  peer->poll();
  EXPECT_TRUE(peer->all<DatagramKey>().empty());
  EXPECT_TRUE(client.lost.empty());
}

TEST_F(SealedDatagramsTest, AKeyHoldsBackNoFrameOfAViewerWithoutTls) {
  SealingServer server(io, clock);
  const auto peer = viewer(server);
  server.publish(1);
  server.broadcaster.changeKey({2, {}, 1s});  // both wait for the network's thread
  EXPECT_TRUE(receives<CodedFrame>(*peer));
}

TEST_F(SealedDatagramsTest, AViewerWithoutTlsReceivesNoGroup) {
  std::unique_ptr<DatagramServer> server;
  try {
    server = std::make_unique<DatagramServer>(io, clock, loopbackGroup("239.255.74.47"),
                                              "127.0.0.1", true);
  } catch (const std::exception& error) {
    GTEST_SKIP() << "no multicast on the loopback here: " << error.what();
  }
  const auto peer = viewer(*server);
  EXPECT_FALSE(peer->all<Welcome>().at(0).group);
  for (std::uint64_t id = 1; id <= 10; ++id) {
    server->publish(id);
    turn();
  }
  EXPECT_EQ(server->sender->counts().group.sent, 0U);
}

TEST_F(SealedDatagramsTest, TheHourlyRotationIsNotNoticed) {
  SealingServer server(io, clock);
  TestClient client(io, clock, 0, byTls(server));
  ASSERT_TRUE(streamByUdp(server, client));
  for (int hour = 0; hour < 3; ++hour) {
    server.key_clock.advance(1h);
    ASSERT_TRUE(streamOn(server, client, 10)) << "the key is announced";
    server.key_clock.advance(1s);
    ASSERT_TRUE(streamOn(server, client, 10)) << "the key is used";
  }
  expectAllOpened(client);
}

TEST_F(SealedDatagramsTest, AfterARevocationTheOthersGoOn) {
  SealingServer server(io, clock);
  TestClient client(io, clock, 0, byTls(server));
  ASSERT_TRUE(streamByUdp(server, client));
  for (int i = 0; i < 3; ++i) {
    server.signer.revokeKey();
    ASSERT_TRUE(streamOn(server, client, 10));
  }
  EXPECT_EQ(client.connection.delivery().transport, Transport::kDatagrams);
  EXPECT_TRUE(client.lost.empty());
}

TEST_F(SealedDatagramsTest, AViewerThatJoinsLaterReceivesTheNewestKey) {
  SealingServer server(io, clock);
  server.key_clock.advance(1h);
  server.publish(1);  // announces the second key
  server.key_clock.advance(1s);
  TestClient client(io, clock, 0, byTls(server));
  ASSERT_TRUE(streamByUdp(server, client));
  ASSERT_TRUE(streamOn(server, client, 10));
  expectAllOpened(client);
}

TEST_F(SealedDatagramsTest, AnotherOriginHasAKeyOfItsOwn) {
  SealingServer server(io, clock);
  TestClient client(io, clock, 0, byTls(server));
  ASSERT_TRUE(streamByUdp(server, client));
  server.changeOrigin();
  ASSERT_TRUE(runUntil([&] { return !client.news.empty(); }));
  ASSERT_TRUE(streamByUdp(server, client));
  ASSERT_TRUE(streamOn(server, client, 20));
  EXPECT_EQ(client.connection.datagrams().not_opened, 0U);
}

TEST_F(SealedDatagramsTest, AKeyWithoutTlsEndsTheConnection) {
  SealingServer server(io, clock);
  TestClient client(io, clock, 0, [&](auto& settings) {
    settings.dial = [this, &server](asio::io_context&, const Endpoint&, Duration,
                                    client::DialCancellation&) -> asio::awaitable<client::Dialled> {
      auto [ours, theirs] = MemoryChannel::pair(io, kMaxSmallMessageBytes);
      const auto host = asio::ip::make_address("127.0.0.1");
      theirs->pretendTls({host, host}, "127.0.0.1:1");  // the server is wrong
      server.broadcaster.accept(std::move(theirs));
      co_return std::move(ours);
    };
  });
  ASSERT_TRUE(runUntil([&] { return !client.lost.empty() || !client.failure.empty(); }));
  const std::string why = client.failure.empty() ? client.lost[0] : client.failure;
  EXPECT_EQ(why, "a key of datagrams arrived without TLS");
  EXPECT_EQ(client.welcomes, 0);
}

}  // namespace
}  // namespace hapticast::testing
