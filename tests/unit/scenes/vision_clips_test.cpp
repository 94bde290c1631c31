// SPDX-License-Identifier: MIT
// All of vision over the real clips.
#include <gtest/gtest.h>

#include <set>

#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

struct ClipRun {
  std::vector<VisionResult> results;
  std::vector<cv::Mat> masks;  // of the first object; empty where there is none
};

ClipRun runClip(const std::string& clip, double fps, const VisionSettings& settings) {
  const SourceInfo info = test::clipInfo(clip, fps);
  Vision vision(info, settings);
  ClipRun run;
  for (std::uint64_t i = 0;; ++i) {
    const auto frame = test::clipFrame(clip, i);
    if (!frame) break;
    if (auto result = vision.push(*frame, mediaTime(double(i) / fps)))
      run.results.push_back(*result);
  }
  for (VisionResult& result : vision.flush()) run.results.push_back(result);
  for (const VisionResult& result : run.results) {
    cv::Mat mask = cv::Mat::zeros(info.height_px, info.width_px, CV_8UC1);
    if (!result.frame.objects.empty()) {
      const Relief& relief = *result.frame.objects[0].relief;
      for (std::size_t k = 0; k < relief.mask.size(); ++k) {
        const int u = relief.rect.u + static_cast<int>(k) % relief.rect.width;
        const int v = relief.rect.v + static_cast<int>(k) / relief.rect.width;
        mask.at<uchar>(v, u) = relief.mask[k];
      }
    }
    run.masks.push_back(mask);
  }
  return run;
}

TEST(Vision, TheDragonIsHeldThroughTheDeskClip) {
  if (!test::clipFrame("visp_rbt_desk", 0)) GTEST_SKIP() << "no clips in " << test::clipsFolder();
  VisionSettings settings;
  settings.object_points = {{{505, 330}}};
  const ClipRun run = runClip("visp_rbt_desk", 30, settings);
  ASSERT_EQ(run.results.size(), 99U);
  double last_area = 0;
  for (std::size_t i = 0; i < run.results.size(); ++i) {
    ASSERT_EQ(run.results[i].frame.objects.size(), 1U) << i;
    EXPECT_EQ(run.results[i].frame.objects[0].id, run.results[0].frame.objects[0].id);
    // Truth by colour: the dragon is the only saturated yellow thing right of the middle.
    cv::Mat hsv;
    cv::cvtColor(run.results[i].color, hsv, cv::COLOR_BGR2HSV);
    cv::Mat yellow;
    cv::inRange(hsv, cv::Scalar(14, 110, 90), cv::Scalar(34, 255, 255), yellow);
    const double area = cv::countNonZero(run.masks[i]);
    EXPECT_GT(cv::countNonZero(yellow & (run.masks[i] > 0)) / area, 0.75) << i;
    EXPECT_GT(area, 5500) << i;
    EXPECT_LT(area, 11500) << i;
    if (i > 0) {
      EXPECT_NEAR(area / last_area, 1, 0.15) << i;
    }
    last_area = area;
    const Motion& motion = run.results[i].frame.objects[0].motion;
    EXPECT_TRUE(motion.position_mm.allFinite() && motion.acceleration_mm_s2.allFinite());
    EXPECT_LT(motion.velocity_mm_s.norm(), 400) << i;
    EXPECT_TRUE(run.results[i].frame.objects[0].impacts.empty()) << i;
  }
}

TEST(Vision, ThePersonIsHeldThroughTheTypingClip) {
  if (!test::clipFrame("dkvfx_typing_person", 0))
    GTEST_SKIP() << "no clips in " << test::clipsFolder();
  VisionSettings settings;
  settings.object_points = {{{125, 260}}};
  const ClipRun run = runClip("dkvfx_typing_person", 24, settings);
  ASSERT_EQ(run.results.size(), 48U);
  for (std::size_t i = 0; i < run.results.size(); ++i) {
    ASSERT_EQ(run.results[i].frame.objects.size(), 1U) << i;
    EXPECT_EQ(run.results[i].frame.objects[0].id, run.results[0].frame.objects[0].id);
    EXPECT_TRUE(run.results[i].frame.objects[0].impacts.empty()) << i;
    const cv::Mat inside = run.masks[i] > 0;
    const double area = cv::countNonZero(inside);
    EXPECT_GT(area, 30e3) << i;
    EXPECT_LT(area, 48e3) << i;
    for (const cv::Point part :
         {cv::Point(125, 260), cv::Point(125, 90), cv::Point(60, 220), cv::Point(215, 300)}) {
      EXPECT_NE(inside.at<uchar>(part), 0) << i << " " << part;  // chest, head, shoulder, hand
    }
    EXPECT_EQ(inside.at<uchar>(350, 270), 0) << i;  // the table
    EXPECT_EQ(inside.at<uchar>(50, 300), 0) << i;   // nothing
  }
}

TEST(Vision, SomethingIsFoundLostAndFoundAgainInTheTurningClip) {
  if (!test::clipFrame("tum_fr1_rpy", 0)) GTEST_SKIP() << "no clips in " << test::clipsFolder();
  const ClipRun run = runClip("tum_fr1_rpy", 30, {});
  ASSERT_EQ(run.results.size(), 150U);
  std::set<std::uint32_t> ids;
  std::set<std::int64_t> jolts;
  int without = 0;
  int fading = 0;
  for (const VisionResult& result : run.results) {
    without += result.frame.objects.empty() ? 1 : 0;
    for (const HapticObject& object : result.frame.objects) {
      ids.insert(object.id);
      fading += object.motion.quality < 0.5 ? 1 : 0;
      for (const Impact& impact : object.impacts)
        jolts.insert(impact.time.time_since_epoch().count());
    }
  }
  EXPECT_GE(ids.size(), 2U);
  EXPECT_GT(without, 5);
  EXPECT_LT(without, 120);
  EXPECT_GT(fading, 5);
  // The camera is shaken: near 3 s the picture really jumps by 6 px from one frame to the next.
  EXPECT_LE(jolts.size(), 2U);
}

}  // namespace
}  // namespace hapticast::server
