// SPDX-License-Identifier: MIT
#include "server/vision/describe.hpp"

#include <gtest/gtest.h>

#include "server/vision/motion/pose_history.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

NominalFrame nominalFrame() {
  Workspace workspace;
  workspace.width_px = 320;
  workspace.height_px = 240;
  return {workspace, {600, 900}};
}

TrackedObject objectAtPixel(int u, double depth_mm) {
  TrackedObject out;
  out.id = 5;
  out.surface.box = {u, 50, 40, 30};
  out.surface.mask = cv::Mat(30, 40, CV_8UC1, cv::Scalar(255));
  out.surface.measured = out.surface.mask.clone();
  out.surface.depth = cv::Mat(30, 40, CV_32FC1, cv::Scalar(depth_mm));
  out.pose = {u + 20.0, 65.0, depth_mm, 0.0, true};
  out.quality = 0.8;
  out.visible_fraction = 0.7;
  return out;
}

Motion motionAt(const MotionHistory& history, std::uint64_t frame) {
  return history.motion(5, history.window(5, frame, 3, nominalFrame()), 3, nominalFrame());
}

TEST(Describe, PutsPosesIntoTheNominalFrame) {
  const Sample sample = nominalFrame().sample({320, 0, 600, 0.3, true}, 2.0);
  EXPECT_EQ(sample.position_mm, Vec3(80, 60, 30));
  EXPECT_EQ(nominalFrame().sample({160, 120, 900, 0, true}, 0).position_mm, Vec3(0, 0, 0));
  EXPECT_EQ(sample.angle_rad, 0.3);
}

TEST(Describe, CarriesReliefMaterialAndQuality) {
  VisionSettings settings;
  settings.material.stiffness_N_mm = 0.7;
  StageReport report;
  const HapticObject object = describeObject(objectAtPixel(100, 750), 9, nullptr, nominalFrame(),
                                             settings, nullptr, report);
  EXPECT_EQ(object.id, 5U);
  EXPECT_EQ(object.layer, 0U);
  EXPECT_EQ(object.changed_in_frame, 9U);
  EXPECT_EQ(object.material.stiffness_N_mm, 0.7);
  EXPECT_EQ(object.motion.quality, 0.8);
  EXPECT_EQ(object.motion.visible_fraction, 0.7);
  EXPECT_EQ(object.relief->rect, (PixelRect{100, 50, 40, 30}));
  EXPECT_NEAR(object.relief->height_mm[615], 15.0F, 1e-3F);
}

TEST(Describe, AnUnchangedReliefIsTheSameRelief) {
  StageReport report;
  const HapticObject first =
      describeObject(objectAtPixel(100, 750), 9, nullptr, nominalFrame(), {}, nullptr, report);
  const HapticObject same =
      describeObject(objectAtPixel(100, 750), 10, &first, nominalFrame(), {}, nullptr, report);
  EXPECT_EQ(same.relief, first.relief);
  EXPECT_EQ(same.changed_in_frame, 9U);
  EXPECT_EQ(report.unchanged, true);
  const HapticObject moved =
      describeObject(objectAtPixel(101, 750), 11, &same, nominalFrame(), {}, nullptr, report);
  EXPECT_NE(moved.relief, first.relief);
  EXPECT_EQ(moved.changed_in_frame, 11U);
  EXPECT_EQ(report.unchanged, false);
}

TEST(Describe, HistoryGivesMotionInNominalUnits) {
  MotionHistory history;
  for (std::uint64_t i = 0; i < 9; ++i) {
    const TrackedObject object = objectAtPixel(100 + static_cast<int>(i), 750 - 10.0 * double(i));
    history.add(5, {i, double(i) / 25, object.pose, {}});
  }
  const Motion motion = motionAt(history, 4);
  EXPECT_NEAR(motion.velocity_mm_s.x(), 0.5 * 25, 1e-6);  // 1 px a frame, 0.5 mm a px
  EXPECT_NEAR(motion.velocity_mm_s.y(), 0, 1e-9);
  EXPECT_NEAR(motion.velocity_mm_s.z(), 1.0 * 25,
              1e-6);  // 10 mm of depth are 1 mm of height, nearer is higher
  EXPECT_EQ(motion.reference_point, ReferencePoint::kVisibleCentroid);
}

TEST(Describe, TheKindOfReferencePointIsThatOfTheFrame) {
  MotionHistory history;
  for (std::uint64_t i = 0; i < 9; ++i) {
    ObjectPose pose = objectAtPixel(100, 750).pose;
    if (i == 4) pose.point = ReferencePoint::kCentreOfMass;
    history.add(5, {i, double(i) / 25, pose, {}});
  }
  EXPECT_EQ(motionAt(history, 4).reference_point, ReferencePoint::kCentreOfMass);
  EXPECT_EQ(motionAt(history, 5).reference_point, ReferencePoint::kVisibleCentroid);
}

TEST(Describe, ALostObjectRestsWhereItWasSeenLast) {
  MotionHistory history;
  for (std::uint64_t i = 0; i < 4; ++i)
    history.add(5, {i, double(i) / 25, objectAtPixel(100 + 2 * int(i), 750).pose, {}});
  const Motion motion = motionAt(history, 6);
  EXPECT_EQ(motion.velocity_mm_s, Vec3::Zero());
  EXPECT_NEAR(motion.position_mm.x(), (126 - 160) * 0.5, 1e-9);
  history.dropBefore(13, 10);
  EXPECT_NE(motionAt(history, 13).position_mm, Vec3::Zero());
  history.dropBefore(14, 10);
  EXPECT_EQ(motionAt(history, 14).position_mm, Vec3::Zero());
}

TEST(Describe, CellsThatStandAreNewOnesAndThoseOfTheFrameBeforeStay) {
  CellFlow measured;
  measured.columns = 2;
  measured.rows = 1;
  measured.step = cv::Mat(1, 2, CV_32FC3, cv::Scalar(1, 2, 3));
  const CellFlow stands = measured.atRest();
  EXPECT_EQ(stands.columns, 2);
  EXPECT_EQ(stands.step.at<cv::Vec3f>(0, 1), cv::Vec3f(0, 0, 0));
  EXPECT_EQ(measured.step.at<cv::Vec3f>(0, 1), cv::Vec3f(1, 2, 3));
  EXPECT_TRUE(CellFlow().atRest().step.empty());
}

}  // namespace
}  // namespace hapticast::server
