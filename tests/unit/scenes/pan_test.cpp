// SPDX-License-Identifier: MIT
// A camera that pans: what is felt of the object is its motion against the background.
#include <gtest/gtest.h>

#include <cmath>

#include "server/vision/vision.hpp"
#include "tests/unit/vision/vision_scenes.hpp"

namespace hapticast::server {
namespace {

constexpr double kTurn = 2 * CV_PI * 1.1;
constexpr double kSwing_px = 15;

// The ball at (u, 120) before a wall that has moved right by `shift_px`.
RgbdFrame panned(std::uint64_t index, double u, double shift_px) {
  const test::BallScene scene;
  RgbdFrame out = scene.frame(index, u, 120);
  const RgbdFrame wall = scene.frame(index, -100, 120);
  cv::Mat moved;
  cv::warpAffine(wall.color, moved, cv::Matx23d(1, 0, shift_px, 0, 1, 0), wall.color.size(),
                 cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  moved.copyTo(out.color, out.mask == 0);
  return out;
}

double panAt_px(std::uint64_t i) { return kSwing_px * std::sin(kTurn * double(i) / 25); }

// Rms acceleration in x, mm/s², of frames far from both ends, less `truth` at their times.
double accelerationError(bool compensate, const std::function<RgbdFrame(std::uint64_t)>& frame,
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
    const double off = result->frame.objects.at(0).motion.acceleration_mm_s2.x() -
                       truth(toSeconds(result->frame.media_time));
    square += off * off;
    ++count;
  }
  return std::sqrt(square / count);
}

TEST(Pan, WhatStandsOnTheBackgroundIsNotAccelerated) {
  const auto frame = [](std::uint64_t i) { return panned(i, 160 + panAt_px(i), panAt_px(i)); };
  const auto none = [](double) { return 0.0; };
  const double swing_mm_s2 = 0.5 * kSwing_px * kTurn * kTurn / std::sqrt(2.0);
  EXPECT_NEAR(accelerationError(false, frame, none), swing_mm_s2, 0.1 * swing_mm_s2);
  EXPECT_LT(accelerationError(true, frame, none), 0.06 * swing_mm_s2);
}

// The camera follows the object, which rests in the picture: the background tells how it moves.
TEST(Pan, WhatTheCameraFollowsIsAccelerated) {
  const auto frame = [](std::uint64_t i) { return panned(i, 160, panAt_px(i)); };
  const auto truth = [](double t) { return 0.5 * kSwing_px * kTurn * kTurn * std::sin(kTurn * t); };
  const double swing_mm_s2 = 0.5 * kSwing_px * kTurn * kTurn / std::sqrt(2.0);
  EXPECT_LT(accelerationError(true, frame, truth), 0.12 * swing_mm_s2);
}

}  // namespace
}  // namespace hapticast::server
