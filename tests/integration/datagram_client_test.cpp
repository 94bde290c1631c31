// SPDX-License-Identifier: MIT
// The client's own way through datagrams: from the real server, through good networks and bad ones.
#include "tests/integration/datagram_fixture.hpp"
#include "tests/support/datagram_bytes.hpp"
#include "tests/support/lossy_link.hpp"

namespace hapticast::testing {
namespace {

using client::Transport;

class DatagramClientTest : public StreamTest {
 protected:
  static std::function<void(client::ConnectionSettings&)> with(
      const client::DeliverySettings& delivery) {
    return [delivery](client::ConnectionSettings& settings) { settings.delivery = delivery; };
  }
  /// A frame about every 20 ms, until `done`.
  bool streamUntil(DatagramServer& server, TestClient& client, const std::function<bool()>& done) {
    auto next = clock.now();
    return runUntil([&] {
      if (clock.now() >= next) {
        server.publish(++id_, side);
        next += std::chrono::milliseconds(20);
      }
      client.drain();
      return done();
    });
  }
  static bool byUdp(const TestClient& client) {
    return client.connection.delivery().transport == Transport::kDatagrams;
  }
  static void expectRisingIds(const TestClient& client) {
    for (std::size_t i = 1; i < client.frames.size(); ++i)
      EXPECT_GT(client.frames[i].second, client.frames[i - 1].second);
  }
  /// So many frames more.
  bool streamOn(DatagramServer& server, TestClient& client, std::size_t frames) {
    const std::size_t enough = client.frames.size() + frames;
    return streamUntil(server, client, [&] { return client.frames.size() >= enough; });
  }

  /// A server that sends to it; null where that is not possible, and why_no_group says why.
  std::unique_ptr<DatagramServer> serverOf(const server::MulticastChoice& group) {
    try {
      return std::make_unique<DatagramServer>(io, clock, group);
    } catch (const std::exception& error) {
      why_no_group = std::string("no multicast on the loopback here: ") + error.what();
      return nullptr;
    }
  }
  /// Until frames come by the group, or the client says why not.
  bool streamToGroup(DatagramServer& server, TestClient& client) {
    return streamUntil(server, client, [&] {
      return client.connection.delivery().transport == Transport::kGroup || !client.news.empty();
    });
  }

  int side = 40;
  std::string why_no_group;

 private:
  std::uint64_t id_ = 0;
};

TEST_F(DatagramClientTest, FramesComeByUdpAndNoMoreOverTcp) {
  DatagramServer server(io, clock);
  TestClient client(io, clock, server.port());
  // Until the clock is known no frame waits for its parts.
  ASSERT_TRUE(runUntil([&] { return client.stream.load().connected; }));
  ASSERT_TRUE(streamUntil(server, client, [&] { return byUdp(client); }));
  ASSERT_TRUE(streamOn(server, client, 20));
  const std::uint64_t sent = server.broadcaster.counts().sent.frames_sent;
  ASSERT_TRUE(streamOn(server, client, 20));
  EXPECT_EQ(server.broadcaster.counts().sent.frames_sent, sent) << "over TCP";
  expectRisingIds(client);
  EXPECT_EQ(client.receiver.counts().lost, 0U);
  EXPECT_EQ(client.receiver.counts().slices_lost, 0U);
  EXPECT_TRUE(client.last_has_field);
  EXPECT_TRUE(client.news.empty());
  EXPECT_GT(client.connection.datagrams().received, 40U);
  EXPECT_EQ(client.connection.datagrams().forged, 0U);
}

TEST_F(DatagramClientTest, AClientThatWantsTcpGetsNoDatagram) {
  DatagramServer server(io, clock);
  TestClient client(io, clock, server.port(), with({.best = Transport::kTcp}));
  ASSERT_TRUE(streamOn(server, client, 20));
  EXPECT_EQ(server.sender->counts().viewers.sent, 0U);
  EXPECT_EQ(client.connection.delivery().transport, Transport::kTcp);
}

TEST_F(DatagramClientTest, CopiesMendANetworkThatLoses) {
  DatagramServer server(io, clock);
  LossyLink link(io, server.port(), LinkProfile{.delay = std::chrono::milliseconds(2)});
  TestClient client(io, clock, link.port(), with({.copies = 4}));
  ASSERT_TRUE(streamUntil(server, client, [&] { return byUdp(client); }));
  link.down().profile.loss = 0.2;
  side = 80;
  ASSERT_TRUE(streamOn(server, client, 150));
  expectRisingIds(client);
  EXPECT_GT(client.connection.datagrams().repeated, 200U);
  EXPECT_GT(link.down().counts.lost, 50U);
  // 0.2^4 of the datagrams are lost in all copies.
  EXPECT_LT(client.receiver.counts().lost, 10U);
  EXPECT_LT(client.receiver.counts().slices_lost, 100U);
  EXPECT_TRUE(client.last_has_field);
}

TEST_F(DatagramClientTest, WhereUdpIsHeldBackFramesComeOverTcp) {
  DatagramServer server(io, clock);
  LossyLink link(io, server.port(), LinkProfile{.largest_bytes = 1});
  TestClient client(io, clock, link.port());
  ASSERT_TRUE(streamUntil(server, client, [&] { return !client.news.empty(); }));
  EXPECT_NE(client.news[0].find("firewall"), std::string::npos) << client.news[0];
  ASSERT_TRUE(streamOn(server, client, 20));
  expectRisingIds(client);
  EXPECT_EQ(client.receiver.counts().lost, 0U);
}

TEST_F(DatagramClientTest, APathTooNarrowForAWholeDatagramIsNotTaken) {
  DatagramServer server(io, clock);
  LossyLink link(io, server.port(), LinkProfile{.largest_bytes = 1231});
  TestClient client(io, clock, link.port());
  side = 8;  // frames of one small datagram, which get through
  ASSERT_TRUE(
      streamUntil(server, client, [&] { return client.connection.datagrams().received > 20; }));
  EXPECT_FALSE(byUdp(client));
  EXPECT_EQ(client.receiver.counts().lost, 0U);
}

TEST_F(DatagramClientTest, UdpThatFailsInMidStreamIsReplacedByTcpAndTheStreamGoesOn) {
  DatagramServer server(io, clock);
  LossyLink link(io, server.port(), LinkProfile{});
  TestClient client(io, clock, link.port());
  ASSERT_TRUE(streamUntil(server, client, [&] { return byUdp(client); }));
  ASSERT_TRUE(streamOn(server, client, 10));
  link.down().profile.largest_bytes = 1;
  const auto failed_at = clock.now();
  ASSERT_TRUE(streamOn(server, client, 10));
  EXPECT_GT(clock.now() - failed_at, std::chrono::milliseconds(300)) << "0.4 s without a frame";
  EXPECT_LT(client.receiver.stream().playout_delay_target, std::chrono::milliseconds(300))
      << "the outage is no jitter";
  ASSERT_TRUE(streamUntil(server, client, [&] { return !client.news.empty(); }));
  EXPECT_EQ(client.news.size(), 1U);
  expectRisingIds(client);
  EXPECT_EQ(client.frames.back().first, client.frames.front().first) << "no new epoch";
  EXPECT_EQ(client.lost.size(), 0U) << "the connection stands";
}

TEST_F(DatagramClientTest, ReportsAServerWithoutDatagramsOnce) {
  TestServer server(io, clock);
  TestClient client(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] { return client.welcomes == 1; }));
  ASSERT_EQ(client.news.size(), 1U);
  EXPECT_NE(client.news[0].find("TCP"), std::string::npos);
}

/// A client that gets the frames of a group on the loopback.
class DatagramGroupTest : public DatagramClientTest {
 protected:
  void SetUp() override {
    server = serverOf(loopbackGroup("239.255.74.48"));
    if (!server) GTEST_SKIP() << why_no_group;
    client = std::make_unique<TestClient>(
        io, clock, server->port(), with({.best = Transport::kGroup, .interface_name = "lo"}));
    ASSERT_TRUE(streamToGroup(*server, *client));
    if (!client->news.empty()) GTEST_SKIP() << client->news[0];
  }
  std::unique_ptr<DatagramServer> server;
  std::unique_ptr<TestClient> client;
};

TEST_F(DatagramGroupTest, AGroupOnTheLoopbackIsJoined) {
  ASSERT_TRUE(streamOn(*server, *client, 20));
  expectRisingIds(*client);
  EXPECT_EQ(server->sender->counts().viewers.sent, 0U) << "none of its own";
  EXPECT_EQ(client->receiver.counts().lost, 0U);
}

/// Somebody on the group's network who signs with a key of his own.
class Forger {
 public:
  /// `welcome`: of any viewer; it has the group's token.
  Forger(asio::io_context& io, const Welcome& welcome)
      : socket_(io, {asio::ip::address_v4::loopback(), 0}),
        group_(asio::ip::make_address(welcome.group->address), welcome.group->port),
        welcome_(welcome) {
    socket_.set_option(asio::ip::multicast::outbound_interface(asio::ip::address_v4::loopback()));
  }
  /// Datagrams of a frame that comes soon.
  void send(int datagrams, std::uint64_t after_frame) {
    const auto body = signedBody({welcome_.stream, 3, after_frame + 50, {}, 0, 2}, {}, key_);
    const auto bytes = datagramBytes(welcome_.group->token, body);
    for (int i = 0; i < datagrams; ++i) socket_.send_to(asio::buffer(bytes), group_);
  }

 private:
  SigningKey key_;
  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint group_;
  Welcome welcome_;
};

TEST_F(DatagramGroupTest, AForgedFloodToTheGroupSendsFramesAnotherWay) {
  Forger forger(io, viewer(*server)->all<Welcome>().at(0));
  const std::size_t frames_before = client->frames.size();
  ASSERT_TRUE(streamUntil(*server, *client, [&] {
    forger.send(50, client->frames.back().second);
    return !client->news.empty();
  }));
  EXPECT_NE(client->news[0].find("somebody forges datagrams"), std::string::npos)
      << client->news[0];
  const std::uint64_t forged = client->connection.datagrams().forged;
  const std::size_t enough = client->frames.size() + 20;
  ASSERT_TRUE(streamUntil(*server, *client, [&] {
    forger.send(50, client->frames.back().second);  // it goes on
    return client->frames.size() >= enough;
  }));
  EXPECT_GT(client->frames.size(), frames_before + 20);
  expectRisingIds(*client);
  EXPECT_EQ(client->connection.datagrams().forged, forged) << "nothing more is verified";
}

TEST_F(DatagramGroupTest, ForgeriesToTheGroupDoNotCountAgainstTheNextTransport) {
  Forger forger(io, viewer(*server)->all<Welcome>().at(0));
  forger.send(60, client->frames.back().second);
  const auto later = clock.now() + std::chrono::milliseconds(1500);
  ASSERT_TRUE(streamUntil(*server, *client, [&] { return clock.now() > later; }));
  ASSERT_EQ(client->connection.datagrams().forged, 60U);
  ASSERT_TRUE(client->news.empty()) << client->news[0];
  ASSERT_TRUE(streamUntil(*server, *client, [&] {
    forger.send(150, client->frames.back().second);
    return !client->news.empty();
  }));
  ASSERT_TRUE(streamUntil(*server, *client, [&] { return byUdp(*client); }));
  ASSERT_TRUE(streamOn(*server, *client, 20));
  EXPECT_TRUE(byUdp(*client));
  EXPECT_EQ(client->news.size(), 1U) << client->news.back();
}

/// Real time that a test bends.
struct BentClock final : Clock {
  [[nodiscard]] LocalTime now() const noexcept override { return bend(SteadyClock().now()); }
  std::function<LocalTime(LocalTime)> bend = [](LocalTime real) { return real; };
};

TEST_F(DatagramClientTest, AFloodIsSeenThoughItsSecondEndsWithIt) {
  const auto server = serverOf(loopbackGroup("239.255.74.48"));
  if (!server) GTEST_SKIP() << why_no_group;
  BentClock bent;
  TestClient client(io, bent, server->port(),
                    with({.best = Transport::kGroup, .interface_name = "lo"}));
  ASSERT_TRUE(streamToGroup(*server, client));
  if (!client.news.empty()) GTEST_SKIP() << client.news[0];
  Forger forger(io, viewer(*server)->all<Welcome>().at(0));
  // Time stands until they are read, and is a second later before they are judged.
  bent.bend = [&client, stands = bent.now()](LocalTime) {
    return stands + std::chrono::seconds(client.connection.datagrams().forged > 100 ? 1 : 0);
  };
  // The link's next look is due before this: after it no second ends any more.
  asio::steady_timer timer(io, std::chrono::milliseconds(100));
  bool looked = false;
  timer.async_wait([&](const boost::system::error_code&) { looked = true; });
  ASSERT_TRUE(runUntil([&] { return looked; }));
  forger.send(120, client.frames.back().second);
  ASSERT_TRUE(runUntil([&] { return !client.news.empty(); }));
  EXPECT_NE(client.news[0].find("somebody forges datagrams"), std::string::npos) << client.news[0];
}

TEST_F(DatagramClientTest, AClientThatCannotJoinUsesUdpAndReportsIt) {
  const auto server = serverOf(loopbackGroup("239.255.74.47"));
  if (!server) GTEST_SKIP() << why_no_group;
  TestClient client(io, clock, server->port(),
                    with({.best = Transport::kGroup, .interface_name = "nowhere"}));
  ASSERT_TRUE(streamUntil(*server, client, [&] { return byUdp(client); }));
  ASSERT_EQ(client.news.size(), 1U);
  EXPECT_NE(client.news[0].find("nowhere"), std::string::npos) << client.news[0];
}

}  // namespace
}  // namespace hapticast::testing
