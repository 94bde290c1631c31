// SPDX-License-Identifier: MIT
#include "server/vision/tracker.hpp"

#include <gtest/gtest.h>

#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

TEST(Tracker, ARepeatedFrameLeavesTheMotionOfTheFrameBeforeAsItWas) {
  const test::BallScene scene;
  VisionSettings settings;
  settings.method = Method::kThesis;
  std::uint32_t ids = 1;
  ClipAnnotations annotations;
  Tracker tracker(scene.info(), settings, nullptr, ids, annotations);
  (void)tracker.next(scene.frame(0, 100, 120), 0.0);
  const std::vector<TrackedObject> moved = tracker.next(scene.frame(1, 104, 120), 0.04);
  const auto measure = [](const TrackedObject& object, const CellFlow& last) {
    return measureCells(object.cells, object.surface, last, MotionMode::kAuto);
  };
  const CellFlow flow = measure(moved.at(0), {});
  const cv::Mat step = flow.step.clone();
  ASSERT_GT(cv::norm(step), 1.0);
  const std::vector<TrackedObject> repeated = tracker.next(scene.frame(1, 104, 120), 0.08);
  EXPECT_EQ(cv::norm(measure(repeated.at(0), flow).step), 0.0);
  EXPECT_EQ(cv::norm(flow.step, step), 0.0) << "the history has it, too";
}

TEST(Tracker, NoStageWritesIntoThePicturesOfAFrame) {
  const auto check = [](bool with_mask, SegmentMode segment, Method method, MotionMode motion) {
    test::BallScene scene;
    scene.with_mask = with_mask;
    VisionSettings settings;
    settings.object_points = {{{100, 120}}};
    settings.segment = segment;
    settings.method = method;
    settings.motion = motion;
    settings.compensate_pan = true;
    Vision vision(scene.info(), settings);
    for (std::uint64_t i = 0; i < 6; ++i) {
      const std::uint64_t steps = i / 2;  // every picture comes twice
      const RgbdFrame frame = scene.frame(i, 100 + 3.0 * double(steps), 120);
      const FrameImages before{
          frame.color.clone(), {}, frame.depth.clone(), frame.mask.clone(), {}};
      (void)vision.push(frame, mediaTime(double(i) / 25));
      EXPECT_TRUE(equalImages(before, {frame.color, {}, frame.depth, frame.mask, {}}));
    }
  };
  for (const bool with_mask : {true, false})
    check(with_mask, SegmentMode::kAuto, Method::kHapticast, MotionMode::kAuto);
  check(true, SegmentMode::kSource, Method::kThesis, MotionMode::kLk);
  check(false, SegmentMode::kEdges, Method::kThesis, MotionMode::kDepth);
}

}  // namespace
}  // namespace hapticast::server
