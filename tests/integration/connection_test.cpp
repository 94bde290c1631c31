// SPDX-License-Identifier: MIT
// The client's connection against the real server, over good and bad networks, and against servers
// that err.
#include <algorithm>

#include "common/protocol/signed_frame.hpp"
#include "common/transport/clock_sync.hpp"
#include "tests/integration/fake_server.hpp"
#include "tests/support/lossy_link.hpp"

namespace hapticast::testing {
namespace {

using ConnectionTest = StreamTest;
using std::chrono::milliseconds;

TEST_F(ConnectionTest, BringsFramesClockAndVideoToTheClient) {
  TestServer server(io, clock);
  TestClient client(io, clock, server.port(), [](auto& s) { s.wants_video = true; });
  ASSERT_TRUE(runUntil([&] { return client.stream.load().connected; }));
  for (std::uint64_t id = 1; id <= 20; ++id) {
    server.publish(id, 8, false);
    ASSERT_TRUE(runUntil([&] {
      client.drain();
      return client.frames.size() == id;
    }));
    EXPECT_TRUE(client.last_has_field);
  }
  server.broadcaster.publish(server::encodeVideo({0, 20, server.media.now(), {0xFF, 0xD8, 1}}));
  ASSERT_TRUE(runUntil([&] { return client.videos.size() == 1; }));
  EXPECT_EQ(client.videos[0].jpeg.size(), 3U);
  EXPECT_EQ(client.receiver.counts().lost, 0U);
  // Both clocks are one here, so the true offset is known.
  const Duration truth = -server.media.zero().time_since_epoch();
  EXPECT_LE(std::chrono::abs(client.stream.load().clock_offset - truth),
            client.receiver.clockErrorBound() + std::chrono::microseconds(1));
  EXPECT_GT(client.connection.bytesReceived(), 0U);
}

TEST_F(ConnectionTest, EstimatesTheClockThroughAJitteryNetwork) {
  const SteadyClock real;  // as the link's
  TestServer server(io, real);
  StreamDescription quick = TestServer::description();
  quick.fps = 240;  // frames come as fast as the link lets them: the jitter decides, not the rate
  server.broadcaster.describe(quick);
  LossyLink link(io, server.port(),
                 {.delay = milliseconds(3), .jitter = milliseconds(10), .seed = 5});
  TestClient client(io, real, link.port(), [](auto& s) { s.ping_interval = milliseconds(10); });
  ASSERT_TRUE(runUntil([&] { return client.stream.load().connected; }));
  for (std::uint64_t id = 1; id <= 40; ++id) {
    server.publish(id);
    ASSERT_TRUE(runUntil([&] {
      client.drain();
      return client.frames.size() + 3 > id;  // some are always on their way
    }));
  }
  ASSERT_TRUE(runUntil([&] {
    client.drain();
    return client.frames.size() == 40;
  }));
  const Duration truth = -server.media.zero().time_since_epoch();
  EXPECT_GE(client.receiver.clockErrorBound(), milliseconds(3)) << "the delay of the link is real";
  const Duration error = client.receiver.clockErrorBound();
  EXPECT_LE(std::chrono::abs(client.stream.load().clock_offset - truth),
            error + std::chrono::microseconds(1));
  for (std::size_t i = 0; i < client.frames.size(); ++i) EXPECT_EQ(client.frames[i].second, i + 1);
  // One frame in twenty takes far longer than 3 + 5 ms (of 10 ms jitter, with 40 frames); how late
  // it seems is as sure as the clock. A slow machine only adds to it.
  EXPECT_GE(client.stream.load().playout_delay_target,
            milliseconds(8) + client::JitterEstimator::kMargin - error);
}

TEST_F(ConnectionTest, IsBackWhenTheServerIs) {
  auto server = std::make_unique<TestServer>(io, clock);
  const std::uint16_t port = server->port();
  TestClient client(io, clock, port);
  server->publish(7);
  ASSERT_TRUE(runUntil([&] {
    client.drain();
    return client.frames.size() == 1;
  }));
  server->stop();
  ASSERT_TRUE(runUntil([&] { return client.lost.size() >= 2; })) << "goodbye, then nobody there";
  EXPECT_NE(client.lost[0].find("the server ends"), std::string::npos) << client.lost[0];
  EXPECT_FALSE(client.stream.load().connected);
  TestServer second(io, clock, {}, port);
  second.publish(1);  // ids start over
  ASSERT_TRUE(runUntil([&] {
    client.drain();
    return client.frames.size() == 2;
  }));
  EXPECT_EQ(client.welcomes, 2);
  EXPECT_GT(client.frames[1].first, client.frames[0].first) << "a new epoch";
  EXPECT_EQ(client.stream.load().first_epoch, client.frames[1].first);
  ASSERT_TRUE(runUntil([&] { return client.stream.load().connected; }));
  EXPECT_TRUE(client.failure.empty());
  EXPECT_LE(client::ConnectionSettings{}.last_retry, std::chrono::seconds(1)) << "and not later";
}

TEST_F(ConnectionTest, ComesBackAfterACutAndAfterAStall) {
  TestServer server(io, clock);
  LossyLink link(io, server.port(), {});
  TestClient client(io, clock, link.port(), [](auto& s) { s.silence_limit = milliseconds(250); });
  ASSERT_TRUE(runUntil([&] { return client.stream.load().connected; }));
  link.cut();
  ASSERT_TRUE(runUntil([&] { return client.welcomes == 2; }));
  ASSERT_EQ(client.lost.size(), 1U);
  link.stall(true);
  ASSERT_TRUE(runUntil([&] { return client.lost.size() >= 2; }));
  EXPECT_NE(client.lost[1].find("stopped sending"), std::string::npos) << client.lost[1];
  link.stall(false);
  ASSERT_TRUE(runUntil([&] { return client.welcomes >= 3 && client.stream.load().connected; }));
}

TEST_F(ConnectionTest, ReportsAtOnceThatThereIsNoSuchHost) {
  TestClient client(io, clock, 7447, [](auto& s) { s.server.host = "no-such-host.invalid"; });
  ASSERT_TRUE(runUntil([&] { return !client.failure.empty(); }));
  EXPECT_EQ(client.failure, "there is no host of this name");
  EXPECT_TRUE(client.lost.empty());
}

TEST_F(ConnectionTest, WaitsPatientlyForAServerThatIsNotThereYet) {
  std::uint16_t port = 0;
  {
    const FakeServer closed(io);
    port = closed.port();
  }
  TestClient client(io, clock, port);
  ASSERT_TRUE(runUntil([&] { return client.lost.size() >= 2; }));
  EXPECT_EQ(client.lost[0], "connection refused");
  EXPECT_TRUE(client.failure.empty());
  TestServer server(io, clock, {}, port);
  EXPECT_TRUE(runUntil([&] { return client.welcomes == 1; }));
}

TEST_F(ConnectionTest, GivesUpOnAnotherVersionOnly) {
  FakeServer server(io);
  TestClient client(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  server.peer->send(WireError{ErrorCode::kServerFull, "all 2 places are taken"});
  ASSERT_TRUE(runUntil([&] { return client.lost.size() == 1; }));
  EXPECT_NE(client.lost[0].find("all 2 places are taken"), std::string::npos);
  ASSERT_TRUE(runUntil([&] { return server.accept(); })) << "tried again";
  server.peer->send(WireError{ErrorCode::kVersion, "this server has protocol version 9"});
  ASSERT_TRUE(runUntil([&] { return !client.failure.empty(); }));
  EXPECT_NE(client.failure.find("protocol version 9"), std::string::npos);
}

TEST_F(ConnectionTest, LeavesServersThatDoNotSpeakTheProtocol) {
  const std::vector<std::pair<std::vector<std::uint8_t>, std::string>> answers = {
      {{'H', 'T', 'T', 'P', '/', '1', '.', '1'}, "are allowed here"},
      {framed(encode(Ping{})), "not a welcome"},
      {framed(std::vector<std::uint8_t>{0xFF, 0xFF}), "not a message"},
      {framed(encode(Welcome{9, 1, 0, {}})), "version"},
  };
  for (const auto& [answer, words] : answers) {
    FakeServer server(io);
    TestClient client(io, clock, server.port());
    ASSERT_TRUE(runUntil([&] { return server.accept(); }));
    server.peer->send(answer);
    ASSERT_TRUE(runUntil([&] { return !client.failure.empty(); })) << words;
    EXPECT_NE(client.failure.find(words), std::string::npos) << client.failure;
    EXPECT_TRUE(client.lost.empty());
    ASSERT_TRUE(runUntil([&] { return io.stopped(); })) << "nothing is left of it";
  }
}

TEST_F(ConnectionTest, WaitsForAServerThatIsSlowToAnswer) {
  FakeServer server(io);
  TestClient client(io, clock, server.port(),
                    [](auto& s) { s.connect_deadline = milliseconds(100); });
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  ASSERT_TRUE(runUntil([&] { return client.lost.size() == 1; }));
  EXPECT_NE(client.lost[0].find("no welcome arrived"), std::string::npos) << client.lost[0];
  ASSERT_TRUE(runUntil([&] { return server.accept(); })) << "tried again";
  server.peer->send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
  ASSERT_TRUE(runUntil([&] { return client.welcomes == 1; }));
  // Once it was there, a server that errs is tried again.
  server.peer->send(WireError{ErrorCode::kMalformed, "what?"});
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  EXPECT_TRUE(client.failure.empty());
}

TEST_F(ConnectionTest, WhereTheWelcomeHasAKeyEveryFrameIsSigned) {
  FakeServer server(io);
  TestClient client(io, clock, server.port());
  SigningKey key;
  Welcome welcome{kProtocolVersion, 1, 0, TestServer::description()};
  welcome.stream = 7;
  welcome.verifying_key = key.verifyingKey();
  CodedFrame frame;
  for (const bool is_signed : {true, false}) {
    ASSERT_TRUE(runUntil([&] { return server.accept(); }));
    server.peer->send(welcome);
    const std::size_t frames = client.frames.size();
    const std::size_t lost = client.lost.size();
    ++frame.id;
    if (is_signed) {
      server.peer->send(testing::framed(*encodeSigned(frame, 7, key)));
    } else {
      server.peer->send(frame);
    }
    ASSERT_TRUE(runUntil([&] {
      client.drain();
      return client.frames.size() > frames || client.lost.size() > lost;
    }));
    EXPECT_EQ(client.frames.size() > frames, is_signed);
    if (is_signed) server.peer->send(WireError{ErrorCode::kMalformed, "again"});
  }
  EXPECT_NE(client.lost.back().find("no valid signature"), std::string::npos) << client.lost.back();
}

TEST_F(ConnectionTest, AServerThatErrsAfterEveryWelcomeIsTriedAtTheSlowestPace) {
  FakeServer server(io);
  TestClient client(io, clock, server.port(), [](auto& s) {
    s.first_retry = milliseconds(5);
    s.last_retry = milliseconds(160);
    s.good_after = milliseconds(300);
  });
  const SteadyClock real;  // its pauses last no less; on `clock` they last no longer
  LocalTime left{}, left_really{};
  const auto round = [&](Duration good_for = {}) {
    ASSERT_TRUE(runUntil([&] { return server.accept(); }));
    server.peer->send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
    server.peer->send(CodedFrame{});
    const std::size_t frames = client.frames.size();
    ASSERT_TRUE(runUntil([&] {
      client.drain();
      return client.frames.size() > frames;
    }));
    const LocalTime until = clock.now() + good_for;
    ASSERT_TRUE(runUntil([&] { return clock.now() >= until; }));
    const std::size_t before = client.lost.size();
    left_really = real.now();
    server.peer->send(WireError{ErrorCode::kUnexpected, "go away"});
    ASSERT_TRUE(runUntil([&] { return client.lost.size() > before; }));
    left = clock.now();
  };
  for (int i = 0; i < 6; ++i) round();
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  EXPECT_GE(real.now() - left_really, milliseconds(160)) << "5, 10, 20, 40, 80, 160 ms";
  server.peer.reset();
  round(milliseconds(400));
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  EXPECT_LT(clock.now() - left, milliseconds(150)) << "after a good connection it begins anew";
}

TEST_F(ConnectionTest, IgnoresPongsItDidNotAskFor) {
  FakeServer server(io);
  TestClient client(io, clock, server.port(),
                    [](auto& s) { s.ping_interval = s.burst_interval = std::chrono::hours(1); });
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  server.peer->send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
  for (int i = 0; i < 20; ++i) server.peer->send(Pong{localTime(i), mediaTime(i), mediaTime(i)});
  server.peer->send(CodedFrame{});
  ASSERT_TRUE(runUntil([&] {
    client.drain();
    return client.frames.size() == 1;
  }));
  EXPECT_FALSE(client.stream.load().connected) << "the clock is not known";
}

TEST_F(ConnectionTest, ReportsGoWithThePingsAfterTheBurst) {
  FakeServer server(io);
  TestClient client(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  RawPeer& peer = *server.peer;
  peer.send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
  ASSERT_TRUE(runUntil([&] {
    peer.poll();
    return peer.all<Ping>().size() >= ClockSync::kBurst + 5;
  }));
  std::size_t pings = 0;
  for (const Message& each : peer.got) {
    pings += std::holds_alternative<Ping>(each);
    if (std::holds_alternative<ReceiverReport>(each)) break;
  }
  EXPECT_EQ(pings, ClockSync::kBurst);
  EXPECT_GE(peer.all<ReceiverReport>().size(), 5U);
}

TEST_F(ConnectionTest, LeavesAServerThatAnswersNoPings) {
  FakeServer server(io);
  TestClient client(io, clock, server.port(), [](auto& s) { s.pong_limit = milliseconds(200); });
  ASSERT_TRUE(runUntil([&] { return server.accept(); }));
  server.peer->send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
  std::uint64_t id = 0;
  ASSERT_TRUE(runUntil([&] {  // frames alone are no clock
    CodedFrame frame;
    frame.id = ++id;
    server.peer->send(frame);
    client.drain();
    return !client.lost.empty();
  }));
  EXPECT_NE(client.lost[0].find("answers no pings"), std::string::npos) << client.lost[0];
  EXPECT_TRUE(runUntil([&] { return server.accept(); })) << "tried again";
}

TEST_F(ConnectionTest, StopsCleanlyInEveryState) {
  TestServer server(io, clock);
  auto connected = std::make_unique<TestClient>(io, clock, server.port());
  TestClient resolving(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] { return connected->welcomes == 1; }));
  connected->connection.stop();
  resolving.connection.stop();
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 0; }));
  server.stop();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); }));
}

TEST_F(ConnectionTest, TwentyClientsGetEveryFrame) {
  TestServer server(io, clock);
  std::vector<std::unique_ptr<TestClient>> clients;
  clients.reserve(20);
  for (int i = 0; i < 20; ++i) {
    clients.push_back(std::make_unique<TestClient>(io, clock, server.port()));
  }
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 20; }));
  for (std::uint64_t id = 1; id <= 25; ++id) {
    server.publish(id, 100);
    ASSERT_TRUE(runUntil([&] {
      for (const auto& each : clients) each->drain();
      return std::all_of(clients.begin(), clients.end(),
                         [&](const auto& each) { return each->frames.size() == id; });
    }));
  }
  EXPECT_EQ(server.broadcaster.counts().sent.frames_sent, 20U * 25U);
  EXPECT_EQ(server.broadcaster.counts().sent.dropped(), 0U);
}

TEST_F(ConnectionTest, ReceivesTheProgressOfTheServerBeforeTheFirstFrame) {
  TestServer server(io, clock);
  TestClient early(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] { return early.welcomes == 1; }));
  server.broadcaster.prepare(0.25);
  server.broadcaster.prepare(0.5);
  ASSERT_TRUE(runUntil([&] { return early.shares.size() == 2; }));
  EXPECT_EQ(early.shares, (std::vector{0.25, 0.5}));
  TestClient late(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] { return late.shares.size() == 1; }));
  EXPECT_EQ(late.shares, std::vector{0.5});
  server.publish(1);
  TestClient last(io, clock, server.port());
  ASSERT_TRUE(runUntil([&] {
    last.drain();
    return !last.frames.empty();
  }));
  EXPECT_TRUE(last.shares.empty());
}

}  // namespace
}  // namespace hapticast::testing
