// SPDX-License-Identifier: MIT
// The mappings of common/geometry: image px <-> nominal mm (Eq. 7-10), nominal mm <-> device mm.
#include "common/geometry.hpp"

#include <gtest/gtest.h>

namespace hapticast {
namespace {

constexpr double kExact = 1e-12;

void expectNear(const Vec2& actual, const Vec2& expected) {
  EXPECT_NEAR(actual.x(), expected.x(), kExact);
  EXPECT_NEAR(actual.y(), expected.y(), kExact);
}

TEST(Geometry, TopLeftCornerOfThePictureIsLeftAndUp) {
  const Workspace workspace;
  expectNear(workspace.toImage({-80.0, 60.0}), {0.0, 0.0});
  expectNear(workspace.toImage({80.0, -60.0}), {640.0, 480.0});
  expectNear(workspace.toImage({-80.0, -60.0}), {0.0, 480.0});
  expectNear(workspace.toImage({0.0, 0.0}), {320.0, 240.0});
}

TEST(Geometry, UpInTheWorkspaceIsUpInThePicture) {
  const Workspace workspace;
  EXPECT_LT(workspace.toImage({0.0, 10.0}).y(), workspace.toImage({0.0, 0.0}).y());
  EXPECT_GT(workspace.toImage({10.0, 0.0}).x(), workspace.toImage({0.0, 0.0}).x());
}

TEST(Geometry, AWidePictureIsFittedInWithOneScale) {
  Workspace workspace;
  workspace.width_px = 1280;
  workspace.height_px = 720;
  expectNear(workspace.mmPerPixel(), {0.125, 0.125});
  expectNear(workspace.toNominal({0.0, 0.0}), {-80.0, 45.0});
  expectNear(workspace.toNominal({1280.0, 720.0}), {80.0, -45.0});
}

TEST(Geometry, ATallPictureIsFittedInWithOneScale) {
  Workspace workspace;
  workspace.width_px = 480;
  workspace.height_px = 960;
  expectNear(workspace.mmPerPixel(), {0.125, 0.125});
  expectNear(workspace.toNominal({0.0, 0.0}), {-30.0, 60.0});
}

TEST(Geometry, StretchUsesTheWholeWorkspaceWithTwoScales) {
  Workspace workspace;
  workspace.width_px = 1280;
  workspace.height_px = 720;
  workspace.stretch = true;
  expectNear(workspace.mmPerPixel(), {0.125, 120.0 / 720.0});
  expectNear(workspace.toImage({-80.0, 60.0}), {0.0, 0.0});
  expectNear(workspace.toImage({80.0, -60.0}), {1280.0, 720.0});
}

TEST(Geometry, ImageMappingIsUndoneByItsInverse) {
  for (const bool stretch : {false, true}) {
    Workspace workspace;
    workspace.width_px = 512;
    workspace.height_px = 424;
    workspace.stretch = stretch;
    for (const Vec2& px : {Vec2(0.5, 0.5), Vec2(-30.0, 900.0), Vec2(511.5, 200.25)}) {
      expectNear(workspace.toImage(workspace.toNominal(px)), px);
    }
  }
}

TEST(Geometry, DeviceMappingRoundTrip) {
  const DeviceMapping mapping = DeviceMapping::fit(Workspace(), {130.0, 110.0, 60.0});
  for (const Vec3& point : {Vec3(0.0, 0.0, 0.0), Vec3(-80.0, 60.0, 30.0), Vec3(12.5, -7.0, -5.0)}) {
    EXPECT_LT((mapping.toNominal(mapping.toDevice(point)) - point).norm(), 1e-10);
  }
}

TEST(Geometry, DeviceMappingFitsTheWholeNominalVolumeAndTouchesOneSide) {
  const Workspace workspace;
  for (const Vec3& device_mm : {Vec3(160.0, 120.0, 70.0), Vec3(80.0, 500.0, 500.0),
                                Vec3(400.0, 60.0, 300.0), Vec3(500.0, 500.0, 35.0)}) {
    const DeviceMapping mapping = DeviceMapping::fit(workspace, device_mm);
    const Vec3 high = mapping.toDevice({80.0, 60.0, 65.0});
    const Vec3 low = mapping.toDevice({-80.0, -60.0, -5.0});
    EXPECT_LT((high + low).norm(), kExact) << "about the device's origin";
    const Vec3 used = (high - low).cwiseQuotient(device_mm);
    EXPECT_NEAR(used.maxCoeff(), 1.0, kExact) << "largest that fits";
  }
}

TEST(Geometry, DeviceMappingKeepsSlopes) {
  const DeviceMapping mapping = DeviceMapping::fit(Workspace(), {130.0, 110.0, 60.0});
  const Vec3 step = mapping.toDevice({1.0, 2.0, 4.0}) - mapping.toDevice(Vec3::Zero());
  EXPECT_NEAR(step.z() / step.x(), 4.0, kExact);
  EXPECT_NEAR(step.y() / step.x(), 2.0, kExact);
}

}  // namespace
}  // namespace hapticast
