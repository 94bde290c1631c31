// SPDX-License-Identifier: MIT
// Where a clip begins again: a still object goes on, a moved one is a new scene.
#include <gtest/gtest.h>

#include "server/vision/vision.hpp"
#include "tests/scenes/noisy_ball.hpp"

namespace hapticast::server {
namespace {

using test::NoisyBall;

constexpr std::uint64_t kFrames = 30;

// Three rounds of a clip through vision.
std::vector<HapticFrame> rounds(const SourceInfo& info, const VisionSettings& settings,
                                std::uint64_t frames,
                                const std::function<RgbdFrame(std::uint64_t)>& make) {
  test::FunctionSource source(info, frames, make);
  Vision vision(info, settings);
  EXPECT_TRUE(vision.scan(source, {}));
  std::vector<HapticFrame> out;
  double time_s = 1.0;
  for (int round = 0; round < 3; ++round) {
    while (const auto frame = source.read()) {
      if (const auto result = vision.push(*frame, mediaTime(time_s += 0.04)))
        out.push_back(result->frame);
    }
    source.rewind();
  }
  for (const VisionResult& result : vision.flush()) out.push_back(result.frame);
  EXPECT_EQ(out.size(), 3 * frames);
  return out;
}

void expectOneStillness(const std::vector<HapticFrame>& frames, std::size_t settled) {
  const HapticObject& first = frames.at(settled).objects.at(0);
  for (std::size_t i = settled; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].epoch, frames[0].epoch) << i;
    ASSERT_EQ(frames[i].objects.size(), 1U) << i;
    const HapticObject& object = frames[i].objects[0];
    EXPECT_EQ(object.id, first.id) << i;
    EXPECT_EQ(object.relief->mask, first.relief->mask) << i;
    EXPECT_EQ(object.relief->height_mm, first.relief->height_mm) << i;
    EXPECT_LT((object.motion.position_mm - first.motion.position_mm).norm(), 0.02) << i;
    EXPECT_EQ(object.motion.velocity_mm_s, Vec3::Zero()) << i;
    EXPECT_EQ(object.motion.acceleration_mm_s2, Vec3::Zero()) << i;
  }
}

TEST(Wrap, ANoisyStillClipGoesOnUnderItsIdAndEpoch) {
  for (const bool with_mask : {true, false}) {
    SCOPED_TRACE(with_mask);
    const NoisyBall ball;
    VisionSettings settings;
    settings.object_points = {{{160, 120}}};
    expectOneStillness(rounds(ball.scene.info(), settings, kFrames,
                              [&](std::uint64_t i) {
                                RgbdFrame frame = ball.frame(i, 160, 120, 0);
                                if (!with_mask) frame.mask.release();
                                return frame;
                              }),
                       kFrames - 2);
  }
}

TEST(Wrap, ARepeatedPictureGoesOnUnderItsIdAndEpoch) {
  const test::BallScene scene;
  expectOneStillness(
      rounds(scene.info(), {}, 1, [&](std::uint64_t) { return scene.frame(0, 160, 120); }), 0);
}

// Clean depth is not held; that something passes behind the object changes nothing of its own.
TEST(Wrap, ACleanBodyBeforeAMovingOneGoesOnUnderItsIdAndEpoch) {
  const test::BallScene scene;
  VisionSettings settings;
  settings.plan.everything = true;  // whether it is smoothed is no matter of the wrap
  expectOneStillness(rounds(scene.info(), settings, 10,
                            [&](std::uint64_t i) {
                              RgbdFrame frame = scene.frame(i, 160, 120);
                              frame.depth(cv::Rect(10 + 5 * int(i), 10, 20, 20)).setTo(1100);
                              return frame;
                            }),
                     0);
}

TEST(Wrap, MotionAcrossItStartsANewSceneEachTime) {
  const NoisyBall ball;
  VisionSettings settings;
  settings.object_points = {{{120, 120}}};
  // At rest, moved by 60 px, at rest again.
  const auto frames = rounds(ball.scene.info(), settings, 3 * kFrames, [&](std::uint64_t i) {
    const double moved = std::clamp(double(i) - double(kFrames), 0.0, 20.0);
    return ball.frame(i, 120 + 3 * moved, 120, 0);
  });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].epoch, frames[0].epoch + i / (3 * kFrames)) << i;
    if (i % (3 * kFrames) == 0 && i > 0) {
      EXPECT_NE(frames[i].objects.at(0).id, frames[i - 1].objects.at(0).id);
    }
  }
}

// A few hundredths of a millimetre are a tenth of a newton at most: more than the usual budget.
TEST(Wrap, TheErrorBudgetDecides) {
  const test::BallScene scene;
  const auto epochs = [&](double budget_N) {
    VisionSettings settings;
    settings.plan.error_budget_N = budget_N;
    const auto frames = rounds(scene.info(), settings, 12, [&](std::uint64_t i) {
      return scene.frame(i, 160, 120, i < 3 ? 0.05 : 0.0);
    });
    return frames.back().epoch - frames.front().epoch;
  };
  EXPECT_EQ(epochs(0.007), 2U);
  EXPECT_EQ(epochs(0.1), 0U);
}

}  // namespace
}  // namespace hapticast::server
