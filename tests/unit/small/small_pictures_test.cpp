// SPDX-License-Identifier: MIT
// All of vision on small pictures, for the sanitizers: each kind of depth, mask, segmentation,
// motion and method, with points of the author, a lost object, missing depth and a second pass. The
// tests of unit_vision and unit_scenes check the results at full size.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <tuple>

#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server::test {
namespace {

constexpr std::uint64_t kFrames = 24;

using Choice = std::tuple<DepthKind, bool, SegmentMode, MotionMode, Method>;

class SmallPictures : public ::testing::TestWithParam<Choice> {};

BallScene makeScene(DepthKind kind, bool with_mask) {
  return {.width = 160,
          .height = 120,
          .radius_px = 20,
          .near_mm = 700,
          .bulge_mm = 80,
          .background_mm = 1000,
          .kind = kind,
          .with_mask = with_mask,
          .turn_rad = 0.1};
}

/// The ball crosses the picture, is hidden for three frames, and has a hole in its depth.
RgbdFrame makeFrame(const BallScene& scene, std::uint64_t index) {
  RgbdFrame frame = scene.frame(index, 50.0 + 2.0 * double(index), 60, 0.5 * double(index));
  if (index >= 15 && index < 18) {
    frame = scene.frame(index, -300, 60);
    frame.mask = scene.with_mask ? cv::Mat::zeros(frame.color.size(), CV_8UC1) : cv::Mat();
  }
  if (index == 5) frame.depth(cv::Rect(55, 55, 8, 8)) = 0;
  return frame;
}

void expectSound(const VisionResult& result) {
  EXPECT_EQ(result.color.size(), cv::Size(160, 120));
  for (const HapticObject& object : result.frame.objects) {
    if (!object.relief) continue;
    EXPECT_GE(object.relief->rect.u, 0);
    EXPECT_GE(object.relief->rect.v, 0);
    EXPECT_LE(object.relief->rect.u + object.relief->rect.width, 160);
    EXPECT_LE(object.relief->rect.v + object.relief->rect.height, 120);
  }
}

TEST_P(SmallPictures, EachFrameLeavesVisionWhole) {
  const auto [kind, with_mask, segment, motion, method] = GetParam();
  const BallScene scene = makeScene(kind, with_mask);
  VisionSettings settings;
  settings.segment = with_mask ? SegmentMode::kSource : segment;
  settings.motion = motion;
  settings.method = method;
  if (!with_mask) {
    settings.object_points = {{{50, 60}, 0.0, 0}, {{74, 60}, 0.5, 0}};
    settings.not_points = {{{10, 10}, 0.25, 0}};
  }
  FunctionSource source(scene.info(), kFrames,
                        [&](std::uint64_t index) { return makeFrame(scene, index); });
  Vision vision(source.info(), settings);
  (void)vision.scan(source, nullptr);
  std::uint64_t whole = 0;
  for (int pass = 0; pass < 2; ++pass) {
    while (const auto frame = source.read()) {
      const auto media_time = MediaTime(fromSeconds(0.04 * double(pass * 30 + int(frame->index))));
      if (const auto result = vision.push(*frame, media_time)) {
        expectSound(*result);
        ++whole;
      }
    }
    for (const VisionResult& result : vision.flush()) {
      expectSound(result);
      ++whole;
    }
    source.rewind();
  }
  EXPECT_EQ(whole, 2 * kFrames);
}

INSTANTIATE_TEST_SUITE_P(
    Masks, SmallPictures,
    ::testing::Combine(::testing::Values(DepthKind::kMetric, DepthKind::kHeight),
                       ::testing::Values(true), ::testing::Values(SegmentMode::kSource),
                       ::testing::Values(MotionMode::kRgbd, MotionMode::kLk, MotionMode::kDepth,
                                         MotionMode::kNone),
                       ::testing::Values(Method::kHapticast, Method::kThesis)));
INSTANTIATE_TEST_SUITE_P(
    Segmented, SmallPictures,
    ::testing::Combine(
        ::testing::Values(DepthKind::kMetric, DepthKind::kHeight), ::testing::Values(false),
        ::testing::Values(SegmentMode::kAuto, SegmentMode::kBand, SegmentMode::kEdges),
        ::testing::Values(MotionMode::kAuto), ::testing::Values(Method::kHapticast)));

}  // namespace
}  // namespace hapticast::server::test
