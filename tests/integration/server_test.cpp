// SPDX-License-Identifier: MIT
// The server's stream against hand-made peers: who gets what, and what misbehaviour gets.
#include <random>
#include <thread>

#include "common/wire_limits.hpp"
#include "tests/integration/stream_fixture.hpp"
#include "tests/support/log_lines.hpp"

namespace hapticast::testing {
namespace {

using ServerTest = StreamTest;
using std::chrono::milliseconds;

TEST_F(ServerTest, WelcomesAndSendsFramesAndPongs) {
  TestServer server(io, clock);
  const auto peer = viewer(server);
  EXPECT_EQ(peer->all<Welcome>()[0].description, TestServer::description());
  peer->send(Ping{localTime(1.5)});
  server.publish(1, 8, false);
  server.publish(2, 8, false);
  ASSERT_TRUE(runUntil([&] {
    peer->poll();
    return peer->all<CodedFrame>().size() == 2 && !peer->all<Pong>().empty();
  }));
  EXPECT_TRUE(peer->all<CodedFrame>()[0].objects[0].relief);
  EXPECT_FALSE(peer->all<CodedFrame>()[1].objects[0].relief) << "unchanged";
  const Pong pong = peer->all<Pong>()[0];
  EXPECT_EQ(pong.t0, localTime(1.5));
  EXPECT_LE(pong.t1, pong.t2);
  EXPECT_LE(pong.t2, server.media.now());
  EXPECT_EQ(pong.error, Duration::zero()) << "it stamps the frames itself";
}

/// A media clock that follows another machine's.
struct FollowingClock final : MediaClock {
  [[nodiscard]] MediaTime now() const noexcept override { return mediaTime(7.0); }
  [[nodiscard]] Duration errorBound() const noexcept override { return error; }
  Duration error = milliseconds(3);
};

TEST_F(ServerTest, PongsHaveTheErrorOfTheServersClock) {
  FollowingClock media;
  server::Broadcaster broadcaster(io, clock, media, TestServer::description(), {});
  server::Listener listener(io, {"127.0.0.1", 0}, broadcaster);
  listener.start();
  RawPeer peer(io, listener.address().port);
  peer.send(Hello{kProtocolVersion, "raw", false, true});
  const auto pong = [&](std::size_t number) {
    peer.send(Ping{});
    EXPECT_TRUE(receives<Pong>(peer, number));
    return peer.all<Pong>().back();
  };
  EXPECT_EQ(pong(1).error, milliseconds(3));
  media.error = std::chrono::hours(1);
  EXPECT_EQ(pong(2).error, Duration(limits::kClockError_ns)) << "what a message may have";
}

TEST_F(ServerTest, ANewViewerGetsTheWholeLastFrameAtOnce) {
  TestServer server(io, clock);
  const auto first = viewer(server);
  server.publish(1, 8, false);
  server.publish(2, 8, false);
  ASSERT_TRUE(receives<CodedFrame>(*first, 2));
  const auto late = viewer(server);
  ASSERT_TRUE(receives<CodedFrame>(*late, 1));
  EXPECT_EQ(late->all<CodedFrame>()[0].id, 2U);
  EXPECT_TRUE(late->all<CodedFrame>()[0].objects[0].relief);
}

TEST_F(ServerTest, SendsVideoToViewersThatRequestIt) {
  TestServer server(io, clock);
  const auto blind = viewer(server);
  EXPECT_FALSE(server.broadcaster.videoWanted());
  const auto seeing = viewer(server, true);
  EXPECT_TRUE(server.broadcaster.videoWanted());
  server.broadcaster.publish(server::encodeVideo({0, 1, server.media.now(), {0xFF, 0xD8}}));
  server.publish(1);
  ASSERT_TRUE(runUntil([&] {
    blind->poll();
    seeing->poll();
    return !blind->all<CodedFrame>().empty() && !seeing->all<VideoFrame>().empty();
  }));
  EXPECT_TRUE(blind->all<VideoFrame>().empty());
}

TEST_F(ServerTest, SendsAPictureInPartsThatFollowTheReceipts) {
  TestServer server(io, clock);
  RawPeer peer(io, server.port());
  peer.keeps_payloads = true;
  peer.send(Hello{kProtocolVersion, "raw", true, true, "", true});
  ASSERT_TRUE(receives<Welcome>(peer));
  VideoFrame picture{0, 1, server.media.now(), {0xFF, 0xD8}};
  picture.jpeg.resize(100'000, 7);
  server.broadcaster.publish(server::encodeVideo(picture));
  std::vector<std::uint8_t> bytes;
  std::size_t parts = 0;
  ASSERT_TRUE(runUntil([&] {
    peer.poll();
    const auto all = peer.all<PicturePart>();
    for (; parts < all.size(); ++parts)
      bytes.insert(bytes.end(), all[parts].data.begin(), all[parts].data.end());
    std::uint64_t received = 0;
    for (const auto& payload : peer.payloads) received += payload.size();
    if (parts > 0) peer.send(Receipt{received, {}});
    return parts > 0 && bytes.size() == all[0].size;
  }));
  EXPECT_GT(parts, 10U) << "a part is at most 10 ms of the link";
  const auto message = decode(bytes);
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(std::get<VideoFrame>(message.value()).jpeg, picture.jpeg);
  EXPECT_TRUE(peer.all<VideoFrame>().empty());
}

TEST_F(ServerTest, AViewerMayStopItsPicturesAndRequestThemAgain) {
  TestServer server(io, clock);
  const auto peer = viewer(server, true);
  peer->send(Delivery{true, true, 1, false});
  ASSERT_TRUE(runUntil([&] { return !server.broadcaster.videoWanted(); }));
  peer->send(Delivery{true, true, 1});
  peer->send(Delivery{true, true, 1, true});
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.videoWanted(); }));
  server.broadcaster.publish(server::encodeVideo({0, 1, server.media.now(), {0xFF, 0xD8}}));
  EXPECT_TRUE(receives<VideoFrame>(*peer));
}

TEST_F(ServerTest, RefusesAReceiptOfAViewerWithoutParts) {
  TestServer server(io, clock);
  const auto peer = viewer(server, true);
  peer->send(Receipt{1, {}});
  EXPECT_EQ(farewell(*peer).code, ErrorCode::kUnexpected);
}

TEST_F(ServerTest, AnnouncesAnotherStreamToAll) {
  TestServer server(io, clock);
  const auto peer = viewer(server);
  StreamDescription other = TestServer::description();
  other.workspace.width_px = 320;
  server.publish(1);
  server.broadcaster.describe(other);
  ASSERT_TRUE(receives<StreamDescription>(*peer));
  EXPECT_EQ(peer->all<StreamDescription>()[0], other);
  const auto late = viewer(server);
  EXPECT_EQ(late->all<Welcome>()[0].description, other);
  server.publish(2);
  ASSERT_TRUE(receives<CodedFrame>(*late));
  EXPECT_EQ(late->all<CodedFrame>()[0].id, 2U) << "frames of the other picture are void";
}

TEST_F(ServerTest, RefusesAnotherProtocolVersion) {
  TestServer server(io, clock);
  RawPeer peer(io, server.port());
  peer.send(Hello{kProtocolVersion + 1, "future", false, true});
  const WireError error = farewell(peer);
  EXPECT_EQ(error.code, ErrorCode::kVersion);
  EXPECT_NE(error.message.find(std::to_string(kProtocolVersion)), std::string::npos)
      << error.message;
}

TEST_F(ServerTest, RefusesRandomBytesWhileOthersKeepReceiving) {
  TestServer server(io, clock);
  const auto other = viewer(server);
  std::mt19937 random(1);
  for (int round = 0; round < 10; ++round) {
    RawPeer peer(io, server.port());
    std::vector<std::uint8_t> noise(5000);
    for (auto& byte : noise) byte = static_cast<std::uint8_t>(random() | 1U);
    peer.send(noise);
    EXPECT_EQ(farewell(peer).code, ErrorCode::kTooLarge) << "random bytes are a huge length";
    RawPeer framed_noise(io, server.port());
    framed_noise.send(framed(noise));
    EXPECT_EQ(farewell(framed_noise).code, ErrorCode::kMalformed);
  }
  server.publish(1);
  EXPECT_TRUE(receives<CodedFrame>(*other));
  EXPECT_EQ(server.broadcaster.counts().clients, 1U);
  EXPECT_EQ(server.broadcaster.counts().refused, 20U);
}

TEST_F(ServerTest, RefusesTooLongAndEmptyMessages) {
  TestServer server(io, clock);
  const auto peer = viewer(server);
  peer->send(std::vector<std::uint8_t>{0x01, 0x00, 0x01, 0x00});  // 64 KiB + 1
  EXPECT_EQ(farewell(*peer).code, ErrorCode::kTooLarge);
  const auto empty = viewer(server);
  empty->send(std::vector<std::uint8_t>{0, 0, 0, 0});
  EXPECT_EQ(farewell(*empty).code, ErrorCode::kMalformed);
}

TEST_F(ServerTest, RefusesMessagesAtTheWrongMoment) {
  TestServer server(io, clock);
  for (const Message& early : {Message(Ping{}), Message(ReceiverReport{}), Message(CodedFrame{})}) {
    RawPeer peer(io, server.port());
    peer.send(early);
    EXPECT_EQ(farewell(peer).code, ErrorCode::kUnexpected);
  }
  for (const Message& wrong : {Message(Hello{}), Message(Pong{}), Message(Welcome{})}) {
    const auto peer = viewer(server);
    peer->send(wrong);
    EXPECT_EQ(farewell(*peer).code, ErrorCode::kUnexpected);
  }
}

TEST_F(ServerTest, RefusesAFloodOfMessages) {
  TestServer server(io, clock);
  const auto peer = viewer(server);
  for (int i = 0; i < 400; ++i) peer->send(ReceiverReport{});
  EXPECT_EQ(farewell(*peer).code, ErrorCode::kUnexpected);
}

TEST_F(ServerTest, ClosesSilentConnections) {
  server::StreamSettings settings;
  settings.hello_deadline = milliseconds(100);
  settings.idle_timeout = milliseconds(300);
  TestServer server(io, clock, settings);
  RawPeer half_open(io, server.port());
  EXPECT_EQ(farewell(half_open).code, ErrorCode::kTimeout);
  const auto silent = viewer(server);
  EXPECT_EQ(farewell(*silent).code, ErrorCode::kTimeout);
  EXPECT_EQ(server.broadcaster.counts().timed_out, 2U);
}

TEST_F(ServerTest, RefusesMoreClientsThanItHasPlacesFor) {
  server::StreamSettings settings;
  settings.max_clients = 2;
  TestServer server(io, clock, settings);
  auto first = viewer(server);
  const auto second = viewer(server);
  RawPeer third(io, server.port());
  third.send(Hello{});
  EXPECT_EQ(farewell(third).code, ErrorCode::kServerFull);
  first.reset();
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 1; }));
  (void)viewer(server);
}

TEST_F(ServerTest, OnlyASlowReaderLosesFramesAndItsPlace) {
  server::StreamSettings settings;
  settings.write_timeout = milliseconds(500);
  TestServer server(io, clock, settings);
  const auto slow = viewer(server);  // reads nothing from now on
  const auto quick = viewer(server);
  bool dropped = false;
  std::uint64_t id = 0;
  ASSERT_TRUE(runUntil([&] {
    server.publish(++id, 700);
    quick->got.clear();
    // The quick one has every frame, whole, before the next is made.
    EXPECT_TRUE(receives<CodedFrame>(*quick));
    EXPECT_EQ(quick->all<CodedFrame>()[0].id, id);
    dropped = dropped || server.broadcaster.counts().sent.dropped() > 0;
    return server.broadcaster.counts().clients == 1;
  }));
  EXPECT_TRUE(dropped);
  EXPECT_EQ(server.broadcaster.counts().timed_out, 1U);
}

TEST_F(ServerTest, FramesThatAreTooLargeAreLeftOutAndReportedOnce) {
  TestServer server(io, clock);
  RawPeer peer(io, server.port());
  peer.send(Hello{kProtocolVersion, "", false, true});
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.viewers() == 1; }));
  const LogLines log;
  const auto large =
      std::make_shared<const std::vector<std::uint8_t>>(kMaxMessageBytes + 1, std::uint8_t{1});
  for (std::uint64_t id = 1; id <= 3; ++id) {
    server.broadcaster.publish(server::EncodedFrame{0, id, server.media.now(), large,
                                                    std::make_shared<server::LazyKeyFrame>(large)});
  }
  server.publish(4);
  ASSERT_TRUE(runUntil([&] {
    peer.poll();
    return !peer.got.empty() && std::holds_alternative<CodedFrame>(peer.got.back());
  }));
  EXPECT_EQ(std::get<CodedFrame>(peer.got.back()).id, 4U);
  EXPECT_FALSE(peer.closed);
  EXPECT_EQ(log.text(),
            "warning a frame of 8388 kB, more than viewers accept: the server leaves it out\n");
}

TEST_F(ServerTest, AFrameThatDatagramsDoNotCarryStillGoesByTcp) {
  TestServer server(io, clock);
  RawPeer peer(io, server.port());
  peer.send(Hello{kProtocolVersion, "", false, true});
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.viewers() == 1; }));
  const LogLines log;
  HapticFrame made;
  made.id = 1;
  server::EncodedFrame frame = server.encoder.encode(made);
  frame.too_many_datagrams = true;
  server.broadcaster.publish(frame);
  ASSERT_TRUE(runUntil([&] {
    peer.poll();
    return !peer.got.empty() && std::holds_alternative<CodedFrame>(peer.got.back());
  }));
  EXPECT_EQ(
      log.text(),
      "warning a frame of 0 kB, more than datagrams carry: the server sends it by TCP only\n");
}

TEST_F(ServerTest, ReplacesQueuedFramesByNewerOnesWhileBusy) {
  TestServer server(io, clock);
  const auto peer = viewer(server);
  for (std::uint64_t id = 1; id <= 10; ++id) server.publish(id);
  server.broadcaster.describe(TestServer::description());  // nothing new, and the last of all
  ASSERT_TRUE(runUntil([&] {
    peer->poll();
    return peer->all<CodedFrame>().size() >= server::SendQueue::kMaxFrames;
  }));
  const auto frames = peer->all<CodedFrame>();
  ASSERT_EQ(frames.size(), server::SendQueue::kMaxFrames);
  EXPECT_EQ(frames.front().id, 8U);
  EXPECT_EQ(frames.back().id, 10U);
  EXPECT_EQ(server.broadcaster.counts().sent.frames_dropped_full, 7U);
}

TEST_F(ServerTest, CountsFramesAndBytesOfViewersThatLeftToo) {
  TestServer server(io, clock);
  EXPECT_EQ(server.broadcaster.counts().published_at, std::nullopt);
  auto peer = viewer(server);
  server.publish(1);
  server.publish(2);
  ASSERT_TRUE(receives<CodedFrame>(*peer, 2));
  EXPECT_EQ(server.broadcaster.counts().frames, 2U);
  EXPECT_EQ(server.broadcaster.counts().bytes, peer->received_bytes);
  EXPECT_GE(server.broadcaster.counts().delay, Duration::zero());
  EXPECT_LE(server.broadcaster.counts().published_at, clock.now());
  peer->finish();
  farewell(*peer);
  const std::size_t all_bytes = peer->received_bytes;
  peer.reset();
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 0; }));
  EXPECT_EQ(server.broadcaster.counts().bytes, all_bytes);
}

TEST_F(ServerTest, TakesFramesFromAnotherThread) {
  TestServer server(io, clock);
  const auto peer = viewer(server, true);
  std::thread pipeline([&] {
    StreamDescription changed = TestServer::description();
    for (std::uint64_t id = 1; id <= 200; ++id) {
      server.publish(id);
      if (server.broadcaster.videoWanted()) {
        server.broadcaster.publish(server::encodeVideo({0, id, server.media.now(), {0xFF, 0xD8}}));
      }
      changed.largest_acceleration_mm_s2 = static_cast<double>(id);
      server.broadcaster.describe(changed);
    }
  });
  EXPECT_TRUE(runUntil([&] {
    peer->poll();
    const auto frames = peer->all<CodedFrame>();
    const auto descriptions = peer->all<StreamDescription>();
    return !frames.empty() && frames.back().id == 200 && !descriptions.empty() &&
           descriptions.back().largest_acceleration_mm_s2 == 200.0;
  }));
  pipeline.join();
}

TEST_F(ServerTest, SendsGoodbyeAndRunsOutOfWork) {
  TestServer server(io, clock);
  const auto peer = viewer(server);
  server.stop();
  EXPECT_EQ(farewell(*peer).code, ErrorCode::kShuttingDown);
  io.restart();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); })) << "nothing is left to wait for";
}

TEST_F(ServerTest, NamesTheAddressItCannotListenOn) {
  TestServer server(io, clock);
  const auto complaint = [&](const Endpoint& address) {
    try {
      const server::Listener listener(io, address, server.broadcaster);
      return std::string("no complaint");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
  };
  const Endpoint used{"127.0.0.1", server.port()};
  EXPECT_NE(complaint(used).find(toString(used)), std::string::npos);
  EXPECT_NE(complaint(used).find("in use"), std::string::npos);
  for (const Endpoint& wrong : {Endpoint{"nowhere", 80}, {"1.2.3", 80}, {"192.0.2.1", 7447}}) {
    EXPECT_NE(complaint(wrong).find("cannot listen on " + toString(wrong)), std::string::npos);
    EXPECT_EQ(complaint(wrong).find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace hapticast::testing
