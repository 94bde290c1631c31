// SPDX-License-Identifier: MIT
// Another server makes the stream: viewers change to its key, its numbering and its clock within
// their sessions.
#include "tests/integration/datagram_fixture.hpp"
#include "tests/support/datagram_viewer.hpp"

namespace hapticast::testing {
namespace {

using client::Transport;

class OriginTest : public StreamTest {
 protected:
  static std::function<void(client::ConnectionSettings&)> by(Transport transport) {
    return [transport](auto& settings) { settings.delivery.best = transport; };
  }
  /// A frame about every 20 ms, until `done`.
  bool streamUntil(DatagramServer& server, const std::vector<TestClient*>& clients,
                   const std::function<bool()>& done) {
    auto next = clock.now();
    return runUntil([&] {
      if (clock.now() >= next) {
        server.publish(++id_, 40);
        next += std::chrono::milliseconds(20);
      }
      for (TestClient* each : clients) each->drain();
      return done();
    });
  }
  /// The next frame has the id 1 again.
  void restartIds() { id_ = 0; }
  static bool byUdp(const TestClient& client) {
    return client.connection.delivery().transport == Transport::kDatagrams;
  }

 private:
  std::uint64_t id_ = 100;
};

TEST_F(OriginTest, ViewersByTcpAndUdpChangeWithoutAReconnection) {
  DatagramServer server(io, clock);
  TestClient tcp(io, clock, server.port(), by(Transport::kTcp));
  TestClient udp(io, clock, server.port(), by(Transport::kDatagrams));
  ASSERT_TRUE(
      streamUntil(server, {&tcp, &udp}, [&] { return tcp.frames.size() > 5 && byUdp(udp); }));
  const auto datagrams = udp.connection.datagrams();
  const std::uint64_t bytes = udp.connection.bytesReceived();
  server.changeOrigin();
  restartIds();
  const auto changed = [](const TestClient& client) { return client.frames.back().second < 100; };
  ASSERT_TRUE(streamUntil(server, {&tcp, &udp}, [&] {
    return changed(tcp) && changed(udp) && byUdp(udp) && tcp.stream.load().connected &&
           udp.stream.load().connected;
  }));
  for (const TestClient* each : {&tcp, &udp}) {
    EXPECT_TRUE(each->lost.empty()) << each->lost[0];
    EXPECT_EQ(each->welcomes, 1) << "the description is the same";
    ASSERT_EQ(each->news.size(), 1U);
    EXPECT_NE(each->news[0].find("another server makes the stream"), std::string::npos)
        << each->news[0];
    EXPECT_GT(each->frames.back().first, each->frames.front().first) << "a new epoch";
    EXPECT_EQ(each->receiver.counts().lost, 0U);
    EXPECT_TRUE(each->last_has_field);
  }
  EXPECT_EQ(server.broadcaster.counts().welcomed, 2U);
  EXPECT_GT(udp.connection.datagrams().received, datagrams.received) << "counted over both links";
  EXPECT_GT(udp.connection.bytesReceived(), bytes);
  EXPECT_EQ(udp.connection.datagrams().forged, 0U);
}

TEST_F(OriginTest, FramesOfTheKeyBeforeAreRefused) {
  DatagramServer server(io, clock);
  TestClient tcp(io, clock, server.port(), by(Transport::kTcp));
  TestClient udp(io, clock, server.port(), by(Transport::kDatagrams));
  ASSERT_TRUE(streamUntil(server, {&tcp, &udp}, [&] { return !tcp.frames.empty() && byUdp(udp); }));
  server.changeOrigin();
  const std::size_t frames = udp.frames.size();
  ASSERT_TRUE(streamUntil(server, {&tcp, &udp}, [&] {
    return byUdp(udp) && udp.frames.size() > frames && udp.news.size() == 1;
  }));
  server.origin = &server.signer;
  server.publish(1000);
  ASSERT_TRUE(runUntil([&] {
    tcp.drain();
    udp.drain();
    return !tcp.lost.empty() && udp.connection.datagrams().foreign > 0;
  }));
  EXPECT_NE(tcp.lost[0].find("no valid signature"), std::string::npos) << tcp.lost[0];
  EXPECT_NE(udp.frames.back().second, 1000U);
}

TEST_F(OriginTest, NothingOfTheOriginBeforeFollowsTheWelcome) {
  DatagramServer server(io, clock);
  const auto slow = viewer(server, true);
  std::uint64_t id = 1000;
  // A peer that does not read: a frame is written in part, and the queue is full behind it.
  ASSERT_TRUE(runUntil([&] {
    server.publish(++id, 400);
    return server.broadcaster.counts().sent.frames_dropped_full > 0;
  }));
  StreamDescription between = TestServer::description();
  between.name = "waits behind the frame";
  server.broadcaster.describe(between);
  server.broadcaster.publish(server::encodeVideo({0, id, server.media.now(), {0xFF, 0xD8, 1}}));
  slow->send(Ping{localTime(1.0)});
  turn();
  StreamDescription described = TestServer::description();
  described.name = "other";
  server.changeOrigin(described);
  server.publish(1);
  ASSERT_TRUE(runUntil([&] {
    slow->poll();
    const auto frames = slow->all<CodedFrame>();
    return !frames.empty() && frames.back().id == 1;
  }));
  const auto welcomes = slow->all<Welcome>();
  ASSERT_EQ(welcomes.size(), 2U);
  EXPECT_EQ(welcomes[1].session_id, welcomes[0].session_id);
  EXPECT_EQ(welcomes[1].stream, server.other.identity().stream);
  EXPECT_EQ(welcomes[1].verifying_key, server.other.identity().verifying_key);
  EXPECT_EQ(welcomes[1].description, described);
  EXPECT_NE(welcomes[1].datagram_token, 0U);
  EXPECT_NE(welcomes[1].datagram_token, welcomes[0].datagram_token);
  ASSERT_GE(slow->got.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<Welcome>(slow->got[slow->got.size() - 2]))
      << "directly before the first frame";
  EXPECT_TRUE(slow->all<VideoFrame>().empty());
  EXPECT_TRUE(slow->all<Pong>().empty()) << "of a ping by the clock before";
}

TEST_F(OriginTest, TheTokenBeforeIsVoid) {
  DatagramServer server(io, clock);
  const auto tcp = viewer(server);
  const auto local = [](std::uint16_t port) {
    return asio::ip::udp::endpoint(asio::ip::address_v4::loopback(), port);
  };
  const Welcome before = tcp->all<Welcome>()[0];
  DatagramViewer old_viewer(io, before, local(0), local(server.port()));
  old_viewer.echo();
  ASSERT_TRUE(runUntil([&] {
    old_viewer.poll();
    return old_viewer.probes == 1;
  }));
  server.changeOrigin();
  ASSERT_TRUE(receives<Welcome>(*tcp, 2));
  const Welcome after = tcp->all<Welcome>()[1];
  EXPECT_FALSE(server.broadcaster.datagramsWanted());
  DatagramViewer viewer(io, after, local(0), local(server.port()));
  old_viewer.echo();
  viewer.echo(before.datagram_token);
  viewer.echo();
  ASSERT_TRUE(runUntil([&] {
    viewer.poll();
    return viewer.probes == 1;
  }));
  EXPECT_EQ(server.echoes(server::AddressValidation::kOtherStream), 1U);
  EXPECT_EQ(server.echoes(server::AddressValidation::kUnknownToken), 1U);
  server.publish(1);
  ASSERT_TRUE(runUntil([&] {
    viewer.poll();
    return viewer.frames.size() == 1;
  }));
  EXPECT_EQ(viewer.refused, 0U);
  old_viewer.poll();
  EXPECT_TRUE(old_viewer.frames.empty());
  EXPECT_EQ(old_viewer.probes, 1U);
}

}  // namespace
}  // namespace hapticast::testing
