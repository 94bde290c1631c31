// SPDX-License-Identifier: MIT
// The author picks another candidate for the first mask (--object U,V#2).
#include <gtest/gtest.h>

#include "server/preview/candidates.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {
namespace {

TEST(AuthorPick, EachCandidateIsAnotherMaskAndTheFirstIsTheChosenOne) {
  const auto clip = openSource(std::string(HAPTICAST_TESTS) + "/data/typing_hands", 0.0);
  RgbdSource& source = *clip;
  VisionSettings settings;
  settings.object_points = {{{167, 111}}};  // the nearer hand
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
  Vision vision(source.info(), settings);
  EXPECT_FALSE(vision.push(*source.read(), MediaTime{}));
  const auto frames = vision.flush();
  ASSERT_EQ(frames.size(), 1U);
  const PreviewFrame picked{0.0, frames[0].color, {}, frames[0].frame};
  EXPECT_EQ(areaOf(picked), areaOf(candidates[1]));
  source.rewind();
  (void)listCandidates(source, settings);
  EXPECT_EQ(source.read()->index, 0U) << "the source is at its begin again";
}

}  // namespace
}  // namespace hapticast::server
