// SPDX-License-Identifier: MIT
#include "client/view/pointer_input.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hapticast::client {
namespace {

const ScenePlace kPlace({}, {0.0, 0.0}, {640.0, 480.0});

TickReport mapped(double hip_z_mm) {
  TickReport report;
  report.lookup = Lookup::kInterpolated;
  report.hip_mm = {0.0, 0.0, hip_z_mm};
  return report;
}

TEST(PointerInput, ThePointWaitsForTheFirstMappedTick) {
  PointerInput input;
  PointerTarget target;
  input.point({480.0, 160.0});  // the pointer is inside before the window has any report
  input.update(TickReport{}, kPlace, false, target);
  EXPECT_FALSE(target.known) << "no report";
  input.update(TickReport{}, kPlace, true, target);
  EXPECT_FALSE(target.known) << "no mapped tick";
  input.update(mapped(60.0), kPlace, false, target);
  EXPECT_FALSE(target.known) << "no picture";
  input.update(mapped(60.0), kPlace, true, target);
  ASSERT_TRUE(target.known) << "without a further motion of the pointer";
  EXPECT_LT((target.position_mm - Vec3(40.0, 20.0, 35.0)).norm(), 1e-9);
}

TEST(PointerInput, TheHipStartsAboveThePictureWhereverItIs) {
  for (const double hip_z_mm : {0.0, 0.1, 12.0, 60.0}) {
    PointerInput input;
    PointerTarget target;
    input.point({320.0, 240.0});
    input.update(mapped(hip_z_mm), kPlace, true, target);
    EXPECT_EQ(target.position_mm.z(), 35.0) << hip_z_mm;
  }
}

TEST(PointerInput, TheStartIsAboveTheHighestReliefOfAnyWorkspace) {
  for (const double depth_mm : {10.0, 30.0, 200.0}) {
    Workspace workspace;
    workspace.depth_mm = depth_mm;
    PointerInput input;
    PointerTarget target;
    input.point({320.0, 240.0});
    input.update(mapped(0.0), {workspace, {0.0, 0.0}, {640.0, 480.0}}, true, target);
    const double start_mm = depth_mm + PointerInput::kAboveRelief_mm;
    EXPECT_EQ(target.position_mm.z(), start_mm);
    PointerInput::turnWheel(-8.0, target);
    EXPECT_EQ(target.position_mm.z(), start_mm - 8.0);
    PointerInput::turnWheel(20.0, target);
    EXPECT_EQ(target.position_mm.z(), start_mm);
    PointerInput::turnWheel(-3.0, target);
    PointerInput::lift(target);
    EXPECT_EQ(target.position_mm.z(), start_mm);
  }
}

TEST(PointerInput, MotionKeepsTheDepth) {
  PointerInput input;
  PointerTarget target;
  input.point({320.0, 240.0});
  input.update(mapped(60.0), kPlace, true, target);
  PointerInput::turnWheel(-20.0, target);
  input.point({0.0, 0.0});
  input.update(mapped(60.0), kPlace, true, target);
  EXPECT_LT((target.position_mm - Vec3(-80.0, 60.0, 15.0)).norm(), 1e-9);
}

TEST(PointerInput, FractionsOfANotchAddUp) {
  PointerTarget target{.known = true, .position_mm = {0.0, 0.0, 20.0}, .start_z_mm = 35.0};
  for (int i = 0; i < 25; ++i) PointerInput::turnWheel(-0.2, target);
  EXPECT_NEAR(target.position_mm.z(), 15.0, 1e-9);
  PointerInput::turnWheel(-1000.0, target);
  EXPECT_EQ(target.position_mm.z(), PointerInput::kFarthest_mm);
  PointerInput::turnWheel(std::numeric_limits<double>::quiet_NaN(), target);
  EXPECT_EQ(target.position_mm.z(), PointerInput::kFarthest_mm);
}

TEST(PointerInput, TheWheelMovesNothingBeforeTheStart) {
  PointerTarget target;
  PointerInput::turnWheel(-3.0, target);
  PointerInput::lift(target);
  EXPECT_FALSE(target.known);
  EXPECT_EQ(target.position_mm.z(), 0.0);
}

TEST(PointerInput, ALiftBringsTheHipBackAboveThePicture) {
  PointerTarget target{.known = true, .position_mm = {7.0, 8.0, -5.0}, .start_z_mm = 35.0};
  PointerInput::lift(target);
  EXPECT_LT((target.position_mm - Vec3(7.0, 8.0, 35.0)).norm(), 1e-9);
}

}  // namespace
}  // namespace hapticast::client
