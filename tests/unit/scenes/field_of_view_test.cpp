// SPDX-License-Identifier: MIT
// How wide the camera sees: what the author says, what a clip says, what it does to the motion.
#include <gtest/gtest.h>

#include <cmath>

#include "server/source/camera_model.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

using test::BallScene;

TEST(FieldOfView, IsThePinholesFocalLength) {
  const CameraModel camera = CameraModel::ofFieldOfView(90, 640, 480);
  EXPECT_NEAR(camera.fx_px, 320, 1e-9);
  EXPECT_NEAR(camera.fy_px, 320, 1e-9);
  EXPECT_EQ(camera.cx_px, 320);
  EXPECT_EQ(camera.cy_px, 240);
  EXPECT_NEAR(camera.degreesAcross(640), 90, 1e-9);
  // A point at the picture's border, 45 degrees off the axis.
  EXPECT_NEAR(camera.project({100, 0, 100}).x(), 640, 1e-9);
}

// A ball that turns about its vertical axis and swings: what is seen of it goes sideways and in
// depth, and only a camera of the right width separates the turn.
std::vector<Motion> swing(const BallScene& scene, const SourceInfo& info,
                          const VisionSettings& settings) {
  Vision vision(info, settings);
  std::vector<Motion> out;
  const auto keep = [&](const VisionResult& result) {
    out.push_back(result.frame.objects.at(0).motion);
  };
  for (std::uint64_t i = 0; i < 30; ++i) {
    const double t = double(i) / 25;
    BallScene now = scene;
    now.turn_rad = 0.5 * std::sin(6 * t);
    RgbdFrame frame = now.frame(i, 160 + 50 * std::sin(6 * t), 120, 60 * std::sin(6 * t));
    if (const auto result = vision.push(frame, mediaTime(t))) keep(*result);
  }
  for (const VisionResult& result : vision.flush()) keep(result);
  return out;
}

double difference(const std::vector<Motion>& a, const std::vector<Motion>& b) {
  double sum = 0.0;
  double whole = 0.0;
  for (std::size_t i = 4; i + 4 < a.size(); ++i) {
    sum += (a[i].acceleration_mm_s2 - b[i].acceleration_mm_s2).squaredNorm();
    whole += b[i].acceleration_mm_s2.squaredNorm();
  }
  return std::sqrt(sum / whole);
}

TEST(FieldOfView, TheFlagIsTheCameraAndOverrulesTheSources) {
  const BallScene scene;
  const SourceInfo known = scene.info();
  SourceInfo unknown = known;
  unknown.camera.reset();
  SourceInfo wrong = known;
  wrong.camera = CameraModel::ofFieldOfView(100, known.width_px, known.height_px);
  VisionSettings by_flag;
  by_flag.depth_range = DepthRange{550, 900};
  VisionSettings no_flag = by_flag;
  by_flag.fov_deg = scene.camera().degreesAcross(scene.width);
  const std::vector<Motion> right = swing(scene, known, no_flag);
  EXPECT_LT(difference(swing(scene, unknown, by_flag), right), 1e-6);
  EXPECT_LT(difference(swing(scene, wrong, by_flag), right), 1e-6);
  EXPECT_GT(difference(swing(scene, wrong, no_flag), right), 0.01);
  EXPECT_GT(difference(swing(scene, unknown, no_flag), right), 0.001) << "56 degrees, not 45";
}

// Depth is in mm whoever looks; across, a point is z / f mm away per px. So with half the focal
// length the same pictures show a thing twice as wide.
TEST(FieldOfView, WidthsScaleWithIt) {
  const CameraModel narrow{400, 400, 160, 120};
  const CameraModel wide{200, 200, 160, 120};
  const Vec3 a = 800 * narrow.ray(260, 120);
  const Vec3 b = 800 * wide.ray(260, 120);
  EXPECT_DOUBLE_EQ(b.x(), 2 * a.x());
  EXPECT_DOUBLE_EQ(b.z(), a.z());
  EXPECT_NEAR(std::tan(wide.degreesAcross(320) * std::numbers::pi / 360),
              2 * std::tan(narrow.degreesAcross(320) * std::numbers::pi / 360), 1e-12);
}

}  // namespace
}  // namespace hapticast::server
