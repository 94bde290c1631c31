// SPDX-License-Identifier: MIT
// A camera that pans: the rendered motion is that against the background.
#include <gtest/gtest.h>

#include <cmath>

#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

constexpr double kTurn = 2 * CV_PI * 1.1;
constexpr double kSwing_px = 15;

// The ball at `ball_px` before a wall that has moved by `shift_px`.
RgbdFrame panned(std::uint64_t index, const Vec2& ball_px, const Vec2& shift_px) {
  const test::BallScene scene;
  RgbdFrame out = scene.frame(index, ball_px.x(), ball_px.y());
  const RgbdFrame wall = scene.frame(index, -100, 120);
  cv::Mat moved;
  cv::warpAffine(wall.color, moved, cv::Matx23d(1, 0, shift_px.x(), 0, 1, shift_px.y()),
                 wall.color.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  moved.copyTo(out.color, out.mask == 0);
  return out;
}

double panAt_px(std::uint64_t i) { return kSwing_px * std::sin(kTurn * double(i) / 25); }

// Rms acceleration in this direction, mm/s², of frames far from both ends, less `truth` at their
// times.
double accelerationError(bool compensate, const Vec2& direction,
                         const std::function<RgbdFrame(std::uint64_t)>& frame,
                         const std::function<double(double)>& truth) {
  VisionSettings settings;
  settings.compensate_pan = compensate;
  settings.depth_range = DepthRange{650, 850};
  Vision vision(test::BallScene().info(), settings);
  double square = 0;
  int count = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const auto result = vision.push(frame(i), mediaTime(double(i) / 25));
    if (!result || i < 10) continue;
    const Vec3& is_mm_s2 = result->frame.objects.at(0).motion.acceleration_mm_s2;
    const double off =
        is_mm_s2.head<2>().dot(direction) - truth(toSeconds(result->frame.media_time));
    square += off * off;
    ++count;
  }
  return std::sqrt(square / count);
}

const Vec2 kMiddle_px(160, 120);
// Across, up and down, and both: in the picture (v down), and in the nominal frame (y up).
struct Direction {
  Vec2 px, nominal;
};
const Direction kDirections[] = {{{1, 0}, {1, 0}}, {{0, 1}, {0, -1}}, {{0.6, 0.8}, {0.6, -0.8}}};
constexpr double kSwing_mm_s2 = 0.5 * kSwing_px * kTurn * kTurn;

TEST(Pan, AnObjectAtRestOnTheBackgroundIsNotAccelerated) {
  for (const Direction& along : kDirections) {
    const auto frame = [&](std::uint64_t i) {
      return panned(i, kMiddle_px + panAt_px(i) * along.px, panAt_px(i) * along.px);
    };
    const auto none = [](double) { return 0.0; };
    const double swing_mm_s2 = kSwing_mm_s2 / std::sqrt(2.0);
    EXPECT_NEAR(accelerationError(false, along.nominal, frame, none), swing_mm_s2,
                0.1 * swing_mm_s2);
    EXPECT_LT(accelerationError(true, along.nominal, frame, none), 0.06 * swing_mm_s2);
  }
}

// The camera follows the object, which rests in the picture: the background shows its motion.
TEST(Pan, AnObjectThatTheCameraFollowsIsAccelerated) {
  for (const Direction& along : kDirections) {
    const auto frame = [&](std::uint64_t i) {
      return panned(i, kMiddle_px, panAt_px(i) * along.px);
    };
    const auto truth = [](double t) { return kSwing_mm_s2 * std::sin(kTurn * t); };
    EXPECT_LT(accelerationError(true, along.nominal, frame, truth),
              0.12 * kSwing_mm_s2 / std::sqrt(2.0));
  }
}

}  // namespace
}  // namespace hapticast::server
