// SPDX-License-Identifier: MIT
// The author picks another candidate for the first mask (--object U,V#2).
#include <gtest/gtest.h>

#include "server/preview/candidates.hpp"
#include "tests/scenes/drawn_source.hpp"

namespace hapticast::server {
namespace {

/// A red box with a green box on its lower half, both before a wall.
RgbdFrame drawPair(std::uint64_t /*index*/) {
  cv::RNG random(5);
  RgbdFrame frame;
  frame.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 80, 70));
  frame.depth = cv::Mat(120, 160, CV_32FC1, cv::Scalar(1400));
  frame.color(cv::Rect(50, 25, 60, 70)).setTo(cv::Scalar(40, 40, 200));
  frame.color(cv::Rect(50, 60, 60, 35)).setTo(cv::Scalar(40, 190, 60));
  frame.depth(cv::Rect(50, 25, 60, 70)).setTo(800);
  cv::Mat noise(frame.color.size(), CV_8UC3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 8);
  frame.color += noise;
  return frame;
}

TEST(AuthorPick, EachCandidateIsAnotherMaskAndTheFirstIsTheChosenOne) {
  SourceInfo info;
  info.width_px = 160;
  info.height_px = 120;
  test::FunctionSource source(info, 3, drawPair);
  VisionSettings settings;
  settings.object_points = {{{80, 40}}};
  const auto candidates = listCandidates(source, settings);
  ASSERT_GE(candidates.size(), 2U);
  const auto areaOf = [](const PreviewFrame& frame) {
    int area = 0;
    for (const std::uint32_t id : listIds(frame.haptic))
      area += cv::countNonZero(renderMask(frame.haptic, id, frame.color.size()));
    return area;
  };
  EXPECT_NE(areaOf(candidates[0]), areaOf(candidates[1]));
  settings.object_points.front().candidate = 2;
  EXPECT_EQ(areaOf(listCandidates(source, settings).front()), areaOf(candidates[0]));
  EXPECT_EQ(source.read()->index, 0U) << "the source is at its begin again";
}

}  // namespace
}  // namespace hapticast::server
