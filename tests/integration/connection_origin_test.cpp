// SPDX-License-Identifier: MIT
// The client's connection and the origin of its stream: further welcomes in a session, and the keys
// that the client expects.
#include <algorithm>

#include "client/net/welcome_limiter.hpp"
#include "common/transport/clock_sync.hpp"
#include "tests/integration/fake_server.hpp"

namespace hapticast::testing {
namespace {

using ConnectionTest = StreamTest;

TEST_F(ConnectionTest, AfterASecondWelcomeTheClockIsMeasuredAnew) {
  FakeServer server(io);
  TestClient client(io, clock, server.port(),
                    [](auto& s) { s.ping_interval = std::chrono::hours(1); });
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  RawPeer& peer = *server.peer;
  Welcome welcome{kProtocolVersion, 1, 0, TestServer::description()};
  const auto pings = [&](std::size_t count) {
    return runUntil([&] {
      peer.poll();
      return peer.all<Ping>().size() >= count;
    });
  };
  peer.send(welcome);
  ASSERT_TRUE(pings(ClockSync::kBurst));
  welcome.description.name = "another origin";
  peer.send(welcome);
  // The pongs of the first burst are under way to the client with the clock before.
  for (const Ping& each : peer.all<Ping>()) peer.send(Pong{each.t0, mediaTime(9), mediaTime(9)});
  ASSERT_TRUE(pings(2 * ClockSync::kBurst)) << "a burst after each welcome";
  EXPECT_FALSE(client.stream.load().connected);
  EXPECT_EQ(client.welcomes, 2) << "the description is another one";
  const auto sent = peer.all<Ping>();
  for (std::size_t i = ClockSync::kBurst; i < sent.size(); ++i) {
    const MediaTime there(sent[i].t0.time_since_epoch() + std::chrono::hours(5));
    peer.send(Pong{sent[i].t0, there, there});
  }
  ASSERT_TRUE(runUntil([&] { return client.stream.load().connected; }));
  const Duration truth = std::chrono::hours(5);
  EXPECT_LE(std::chrono::abs(client.stream.load().clock_offset - truth),
            client.receiver.clockErrorBound() + std::chrono::microseconds(1));
  EXPECT_TRUE(client.lost.empty());
}

TEST_F(ConnectionTest, LeavesAServerThatChangesItsOriginTooOften) {
  FakeServer server(io);
  TestClient client(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  for (int i = 0; i <= client::kWelcomeBurst; ++i)
    server.peer->send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
  ASSERT_TRUE(runUntil([&] { return client.news.size() >= 3; }));
  turn();
  EXPECT_TRUE(client.lost.empty());
  for (int i = 0; i < 3; ++i)
    server.peer->send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
  ASSERT_TRUE(runUntil([&] { return !client.lost.empty(); }));
  EXPECT_EQ(client.lost[0], "the server changes its origin too often");
  EXPECT_TRUE(runUntil([&] { return server.accept(); })) << "tried again";
}

TEST_F(ConnectionTest, AnotherKeyThanTheExpectedOneEndsTheClient) {
  const KeyBytes expected = SigningKey().verifyingKey();
  for (const bool has_key : {true, false}) {
    FakeServer server(io);
    TestClient client(io, clock, server.port(),
                      [&](auto& s) { s.origin = client::OriginPin("the one", {expected}); });
    ASSERT_TRUE(runUntil([&] { return server.accept(); }));
    Welcome welcome{kProtocolVersion, 1, 0, TestServer::description()};
    if (has_key) welcome.verifying_key = SigningKey().verifyingKey();
    server.peer->send(welcome);
    ASSERT_TRUE(runUntil([&] { return !client.failure.empty(); }));
    EXPECT_TRUE(client.failure.starts_with("the server at the one shows ")) << client.failure;
    EXPECT_EQ(client.welcomes, 0);
    EXPECT_TRUE(client.lost.empty()) << "no retry";
  }
}

TEST_F(ConnectionTest, ASecondWelcomeNeedsAnExpectedKeyToo) {
  const KeyBytes one = SigningKey().verifyingKey();
  const KeyBytes other = SigningKey().verifyingKey();
  FakeServer server(io);
  TestClient client(io, clock, server.port(), [&](auto& s) {
    s.origin = client::OriginPin("the one", {one, other});
  });
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  Welcome welcome{kProtocolVersion, 1, 0, TestServer::description()};
  for (const KeyBytes& each : {one, other}) {
    welcome.verifying_key = each;
    server.peer->send(welcome);
  }
  const auto changes = [&] {
    return std::count(client.news.begin(), client.news.end(),
                      "another server makes the stream from now on");
  };
  ASSERT_TRUE(runUntil([&] { return changes() == 1; }));
  EXPECT_TRUE(client.failure.empty());
  welcome.verifying_key = SigningKey().verifyingKey();
  server.peer->send(welcome);
  ASSERT_TRUE(runUntil([&] { return !client.failure.empty(); }));
  EXPECT_EQ(changes(), 1);
  EXPECT_FALSE(client.stream.load().connected);
}

}  // namespace
}  // namespace hapticast::testing
