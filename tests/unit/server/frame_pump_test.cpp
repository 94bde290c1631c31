// SPDX-License-Identifier: MIT
// The pump of the pipeline and the requests of operators, in virtual time: which frames leave, when
// they are due, and what pause, seek and material change.
#include "server/pipeline/frame_pump.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <utility>
#include <vector>

#include "server/pipeline/operator_requests.hpp"
#include "tests/scenes/ball_scene.hpp"
#include "tests/support/frame_ids.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::server {
namespace {

constexpr std::uint64_t kPumpedFrames = 20;
constexpr Duration kPumpedPeriod = std::chrono::milliseconds(40);

/// A pump over a ball of 20 frames whose waits move the clock.
class FramePumpTest : public ::testing::Test {
 protected:
  static VisionSettings makeSettings() {
    VisionSettings settings;
    settings.depth_range = DepthRange{650, 850};
    settings.low_latency = true;
    return settings;
  }
  FramePump makePump(
      bool loop = false, std::function<void()> on_wait = [] {}) {
    return {{source_, vision_, settings_, encoder_, clock_, media_clock_, &counter_},
            loop,
            [this, on_wait = std::move(on_wait)](MediaTime due) {
              on_wait();
              const MediaTime now = media_clock_.now();
              if (due > now) clock_.advance(due - now);
              return !stop_;
            }};
  }
  /// Runs the pump to the end of the clip. Returns the number of its frames.
  static int runToEnd(FramePump& pump) {
    int frames = 0;
    while (pump.step() == PumpStep::kFrame) ++frames;
    pump.flush();
    return frames;
  }
  void push(const Control& request) {
    requests_.push(request, [this] { ++confirmed_; });
  }
  void pushSeek(double time_s) { push({{}, time_s, {}}); }
  std::size_t countPublished() {
    encoder_.finish();
    return sink_.ids.size();
  }

  std::size_t drawn_ = 0;  // frames that the source has drawn
  const test::BallScene scene_{.width = 64, .height = 48, .radius_px = 10};
  ManualClock clock_;
  LocalMediaClock media_clock_{clock_};
  test::FunctionSource source_{scene_.info(), kPumpedFrames, [this](std::uint64_t index) {
                                 ++drawn_;
                                 return scene_.frame(index, 20.0 + double(index), 24);
                               }};
  VisionSettings settings_ = makeSettings();
  Vision vision_{scene_.info(), settings_};
  FrameIds sink_;
  EncoderThread encoder_{std::vector<StreamSink*>{&sink_}};
  PipelineCounter counter_{clock_};
  OperatorRequests requests_{clock_};
  std::size_t confirmed_ = 0;
  bool stop_ = false;
};

TEST_F(FramePumpTest, PublishesEachFrameOfAClipInItsTime) {
  FramePump pump = makePump();
  const MediaTime begin = media_clock_.now();
  EXPECT_EQ(runToEnd(pump), int(kPumpedFrames));
  EXPECT_EQ(pump.skipped(), 0U);
  EXPECT_EQ(pump.lastPublished() - begin, (kPumpedFrames - 1) * kPumpedPeriod);
  EXPECT_GE(media_clock_.now() - begin, (kPumpedFrames - 1) * kPumpedPeriod);
  EXPECT_EQ(countPublished(), kPumpedFrames);
}

TEST_F(FramePumpTest, SkipsFramesThatAreLate) {
  FramePump pump = makePump();
  EXPECT_EQ(pump.step(), PumpStep::kFrame);
  clock_.advance(5 * kPumpedPeriod);
  EXPECT_EQ(pump.step(), PumpStep::kFrame);
  EXPECT_GT(pump.skipped(), 0U);
}

TEST_F(FramePumpTest, ALoopEndsWithTheServer) {
  FramePump pump = makePump(true);
  for (std::uint64_t i = 0; i < 2 * kPumpedFrames; ++i) EXPECT_EQ(pump.step(), PumpStep::kFrame);
  stop_ = true;
  PumpStep last = PumpStep::kFrame;
  for (std::uint64_t i = 0; i <= kPumpedFrames && last == PumpStep::kFrame; ++i) last = pump.step();
  EXPECT_EQ(last, PumpStep::kEnd);
}

TEST_F(FramePumpTest, ASeekContinuesAtItsTimeAndPublishesNothingBefore) {
  FramePump pump = makePump();
  EXPECT_EQ(pump.step(), PumpStep::kFrame);
  pushSeek(0.6);
  requests_.carryOut(pump, counter_);
  EXPECT_EQ(runToEnd(pump), 5) << "frames 15 to 19";
  EXPECT_EQ(countPublished(), 6U);
}

TEST_F(FramePumpTest, ManyRequestsBecomeOne) {
  FramePump pump = makePump();
  Control material, texture;
  for (int i = 0; i < 180; ++i) {
    material.material.stiffness_N_mm = 0.01 * i;
    texture.material.texture_K_mm = i;
    pushSeek(i % 2 == 0 ? 0.4 : 0.6);
    push(material);
    push(texture);
  }
  EXPECT_EQ(confirmed_, 0U) << "nothing is carried out yet";
  requests_.carryOut(pump, counter_);
  EXPECT_EQ(confirmed_, 540U);
  EXPECT_EQ(settings_.material.stiffness_N_mm, 1.79);
  EXPECT_EQ(settings_.material.texture_K_mm, 179.0);
  EXPECT_EQ(drawn_, 15U) << "one seek, to the last time";
  EXPECT_FALSE(requests_.waits());
}

TEST_F(FramePumpTest, ANewerSeekEndsTheRunningOne) {
  bool pushed = false;
  FramePump pump = makePump(false, [&] {
    if (std::exchange(pushed, true)) return;
    pushSeek(0.2);
  });
  pushSeek(0.6);
  requests_.carryOut(pump, counter_);
  EXPECT_EQ(runToEnd(pump), 15) << "frames 5 to 19";
  requests_.carryOut(pump, counter_);
  EXPECT_EQ(confirmed_, 2U);
}

// An operator who seeks again before each frame cannot stop the stream: the seek that runs after a
// second comes to its end.
TEST_F(FramePumpTest, SeeksWithoutEndDelayTheStreamByASecondAndOneSeek) {
  FramePump pump = makePump(false, [&] {
    clock_.advance(std::chrono::milliseconds(50));  // vision's time for a frame
    pushSeek(0.6);
  });
  pushSeek(0.6);
  const LocalTime begin = clock_.now();
  requests_.carryOut(pump, counter_);
  EXPECT_LE(clock_.now() - begin,
            OperatorRequests::kNewerSeeks + 16 * std::chrono::milliseconds(50));
}

TEST_F(FramePumpTest, APauseHoldsUntilItIsTakenBack) {
  FramePump pump = makePump();
  EXPECT_FALSE(requests_.waits());
  Control control;
  control.paused = true;
  push(control);
  requests_.carryOut(pump, counter_);
  EXPECT_TRUE(requests_.paused());
  EXPECT_EQ(counter_.counts().phase, PipelinePhase::kPause);
  const MediaTime begin = media_clock_.now();
  pump.idle();
  EXPECT_GT(media_clock_.now(), begin);
  control.paused = false;
  push(control);
  requests_.carryOut(pump, counter_);
  EXPECT_FALSE(requests_.paused());
  EXPECT_EQ(runToEnd(pump), int(kPumpedFrames)) << "the pause skipped none";
}

TEST_F(FramePumpTest, MaterialsOfOperatorsAndOfAReloadReachTheSettings) {
  FramePump pump = makePump();
  Control control;
  control.material.stiffness_N_mm = 2.0;
  push(control);
  requests_.carryOut(pump, counter_);
  EXPECT_EQ(settings_.material.stiffness_N_mm, 2.0);
  VisionSettings reloaded = settings_;
  reloaded.material.stiffness_N_mm = 0.3;
  reloaded.mass_kg = 0.2;
  requests_.pushReload(reloaded);
  requests_.carryOut(pump, counter_);
  EXPECT_EQ(confirmed_, 1U) << "a reload is no operator";
  EXPECT_EQ(settings_.material.stiffness_N_mm, 0.3);
  EXPECT_EQ(settings_.mass_kg, 0.2);
}

}  // namespace
}  // namespace hapticast::server
