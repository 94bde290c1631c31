// SPDX-License-Identifier: MIT
// A recording on demand: each viewer has a time line of its own, and no other right.
#include <algorithm>

#include "server/recording/stream_recorder.hpp"
#include "server/recording/viewer_timeline.hpp"
#include "server/show/producers.hpp"
#include "tests/integration/stream_fixture.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::testing {
namespace {

constexpr int kRecordedFrames = 250;
constexpr double kLength_s = 9.96;

/// A server that plays a recording of 10 s, whose frame at t seconds has an object at x = t mm.
class OnDemandTest : public StreamTest {
 protected:
  OnDemandTest() {
    {
      server::StreamRecorder recorder({file_, std::nullopt}, media_);
      recorder.describe(TestServer::description());
      server::FrameEncoder encoder;
      for (int i = 0; i < kRecordedFrames; ++i) {
        HapticFrame frame;
        frame.id = static_cast<std::uint64_t>(i + 1);
        frame.media_time = mediaTime(0.04 * i);
        frame.objects.push_back({1, 0, 1, flatRelief({0, 0, 8, 8}), {}, nullptr, {}, {}});
        frame.objects[0].motion.position_mm.x() = 0.04 * i;
        recorder.publish(encoder.encode(frame));
      }
    }
    reader_.emplace(server::openRecording(file_));
    timelines_.emplace(server::ViewerTimeline::Server{io, media_, signer_, "on demand"}, *reader_,
                       false);
    const RecordingPlayer player(reader_->reopen().value(), false);
    broadcaster_.emplace(io, clock, media_, describeBegin(player, "on demand"),
                         server::StreamSettings{});
    broadcaster_->introduce(signer_.identity());
    broadcaster_->serveEach(*timelines_);
    listener_.emplace(io, Endpoint{"127.0.0.1", 0}, *broadcaster_);
    listener_->start();
  }
  void TearDown() override {
    listener_->stop();
    broadcaster_->stop();
    for (int i = 0; i < 20; ++i) turn();
  }
  [[nodiscard]] std::unique_ptr<RawPeer> join() {
    auto peer = std::make_unique<RawPeer>(io, listener_->address().port);
    peer->send(Hello{kProtocolVersion, "raw", false, true});
    EXPECT_TRUE(receives<Welcome>(*peer));
    EXPECT_TRUE(receives<CodedFrame>(*peer));
    return peer;
  }
  /// Returns the recorded time of the newest frame that `peer` has.
  static double newest_s(RawPeer& peer) {
    peer.poll();
    return peer.all<CodedFrame>().back().objects[0].motion.position_mm.x();
  }
  static std::optional<Timeline> timeline(RawPeer& peer) {
    peer.poll();
    const auto all = peer.all<StreamDescription>();
    return all.empty() ? peer.all<Welcome>()[0].description.timeline : all.back().timeline;
  }
  /// Sends a control and waits until it comes back.
  void control(RawPeer& peer, const Control& control) {
    const std::size_t before = peer.all<Control>().size();
    peer.send(control);
    EXPECT_TRUE(receives<Control>(peer, before + 1));
    EXPECT_EQ(peer.all<Control>().back(), control);
  }

  TempFolder folder_;
  std::string file_ = (folder_ / "stream.mcap").string();
  LocalMediaClock media_{clock};
  server::FrameSigner signer_;
  std::optional<StreamReader> reader_;
  std::optional<server::ViewerTimelines> timelines_;
  std::optional<server::Broadcaster> broadcaster_;
  std::optional<server::Listener> listener_;
};

TEST_F(OnDemandTest, EachViewerSeeksForItselfAlone) {
  const auto peer = join(), other = join();
  ASSERT_TRUE(timeline(*peer));
  EXPECT_NEAR(timeline(*peer)->length_s, kLength_s, 1e-9);
  EXPECT_LT(newest_s(*peer), 2.0);
  control(*peer, {.paused = std::nullopt, .seek_s = 6.0, .material = {}});
  ASSERT_TRUE(runUntil([&] { return newest_s(*peer) >= 6.0; }));
  EXPECT_LT(newest_s(*other), 5.0);
  EXPECT_NEAR(timeline(*peer)->position_s, 6.0, 0.05);
  // The frames are one stream for the viewer: ids and times rise, the place is a new epoch.
  const auto frames = peer->all<CodedFrame>();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_GT(frames[i].id, frames[i - 1].id);
    EXPECT_GT(frames[i].media_time, frames[i - 1].media_time);
  }
  EXPECT_GT(frames.back().epoch, frames.front().epoch);
  const Timeline place = *timeline(*peer);
  EXPECT_NEAR(place.computePosition_s(frames.back().media_time), newest_s(*peer), 1e-6);
}

TEST_F(OnDemandTest, PausesContinuesAndChangesItsSpeed) {
  const auto peer = join();
  control(*peer, {.paused = true, .seek_s = std::nullopt, .material = {}});
  ASSERT_TRUE(runUntil([&] { return timeline(*peer)->speed == 0.0; }));
  const double at_s = newest_s(*peer);
  EXPECT_NEAR(timeline(*peer)->position_s, at_s, 1e-6);
  const std::size_t frames = peer->all<CodedFrame>().size();
  for (int i = 0; i < 100; ++i) turn();
  peer->poll();
  EXPECT_EQ(peer->all<CodedFrame>().size(), frames);
  control(*peer, {.paused = false, .seek_s = std::nullopt, .material = {}, .speed = 4.0});
  ASSERT_TRUE(runUntil([&] { return newest_s(*peer) > at_s + 1.0; }));
  EXPECT_EQ(timeline(*peer)->speed, 4.0);
}

TEST_F(OnDemandTest, TheEndWaitsForASeek) {
  const auto peer = join();
  control(*peer, {.paused = std::nullopt, .seek_s = 9.9, .material = {}});
  ASSERT_TRUE(runUntil([&] { return timeline(*peer)->speed == 0.0; }));
  EXPECT_NEAR(timeline(*peer)->position_s, kLength_s, 1e-9);
  control(*peer, {.paused = std::nullopt, .seek_s = 3.0, .material = {}});
  ASSERT_TRUE(runUntil([&] { return newest_s(*peer) >= 3.0 && newest_s(*peer) < 5.0; }));
  EXPECT_EQ(timeline(*peer)->speed, 1.0);
}

TEST_F(OnDemandTest, TheContentCannotBeChanged) {
  const auto peer = join(), other = join();
  Control control;
  control.material.stiffness_N_mm = 2.0F;
  peer->send(control);
  EXPECT_EQ(farewell(*peer).code, ErrorCode::kForbidden);
  const std::size_t frames = other->all<CodedFrame>().size();
  ASSERT_TRUE(runUntil([&] {
    other->poll();
    return other->all<CodedFrame>().size() > frames + 5;
  }));
}

TEST_F(OnDemandTest, AFloodOfSeeksDelaysNoOtherViewer) {
  const auto peer = join(), other = join();
  for (int i = 0; i < 150; ++i)
    peer->send(Control{.paused = std::nullopt, .seek_s = 0.06 * i, .material = {}});
  const std::size_t frames = other->all<CodedFrame>().size();
  ASSERT_TRUE(runUntil([&] {
    other->poll();
    return other->all<CodedFrame>().size() > frames + 10;
  }));
  EXPECT_TRUE(receives<Control>(*peer, 150));
  ASSERT_TRUE(runUntil([&] { return newest_s(*peer) >= 8.9; }));
  // Merged: far fewer epochs than seeks.
  EXPECT_LT(peer->all<CodedFrame>().back().epoch, 100U);
}

TEST_F(OnDemandTest, OfTwoSeeksInAPauseTheSecondCounts) {
  const auto peer = join();
  control(*peer, {.paused = true, .seek_s = std::nullopt, .material = {}});
  peer->send(Control{.paused = std::nullopt, .seek_s = 4.0, .material = {}});
  peer->send(Control{.paused = std::nullopt, .seek_s = 7.0, .material = {}});
  ASSERT_TRUE(runUntil([&] { return timeline(*peer)->position_s == 7.0; }));
  EXPECT_EQ(timeline(*peer)->speed, 0.0);
}

TEST_F(OnDemandTest, ARemovedRecordingPlaysOn) {
  join().reset();
  std::filesystem::remove(file_);
  const auto peer = join();
  const std::size_t frames = peer->all<CodedFrame>().size();
  ASSERT_TRUE(runUntil([&] {
    peer->poll();
    return peer->all<CodedFrame>().size() > frames + 5;
  }));
}

}  // namespace
}  // namespace hapticast::testing
