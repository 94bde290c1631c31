// SPDX-License-Identifier: MIT
#include "server/vision/motion/reference_point.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "server/source/synthetic/synthetic_scene.hpp"

namespace hapticast::server {
namespace {

const CameraModel kCamera{1200, 1200, 160, 120};
const cv::Size kPicture_px(320, 240);

using DepthAt = std::function<std::optional<double>(const Vec2& image_px)>;

Surface surfaceOf(const DepthAt& depth_mm) {
  Surface out;
  out.box = {{0, 0}, kPicture_px};
  out.mask = cv::Mat::zeros(kPicture_px, CV_8UC1);
  out.depth = cv::Mat::zeros(kPicture_px, CV_32FC1);
  for (int v = 0; v < kPicture_px.height; ++v) {
    for (int u = 0; u < kPicture_px.width; ++u) {
      const auto z = depth_mm({u + 0.5, v + 0.5});
      if (!z) continue;
      out.mask.at<uchar>(v, u) = 255;
      out.depth.at<float>(v, u) = static_cast<float>(*z);
    }
  }
  out.measured = out.mask.clone();
  return out;
}

Surface ellipsoid(const Vec3& centre_mm, const Vec3& semi_axes_mm, const Eigen::Matrix3d& turn) {
  Workspace workspace;
  workspace.width_px = kPicture_px.width;
  workspace.height_px = kPicture_px.height;
  BodyState body;
  body.position_mm = centre_mm;
  body.rotation = turn;
  const SceneInstant scene({workspace, kCamera, {500, 2000}}, body, semi_axes_mm, 0.0);
  return surfaceOf([&](const Vec2& at) -> std::optional<double> {
    const auto hit = scene.hit(at);
    return hit ? std::optional(hit->position_mm.z()) : std::nullopt;
  });
}

// However it is turned, also from nearby and beside the axis, where the outline's middle is not
// before the centre. Measured: at most 1.2 and 0.37 mm off; the blob's own rule is 10 to 20 mm off.
TEST(ReferencePoint, TheCentreOfAnEllipsoidIsFound) {
  struct Case {
    Vec3 centre_mm, semi_axes_mm;
  };
  for (const Case& of : {Case{{15, -8, 1000}, {70, 45, 55}}, Case{{18, -12, 330}, {22, 14, 18}}}) {
    for (int i = 0; i < 12; ++i) {
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(0.5 * i, Vec3(0.6, 0.3, -0.8).normalized()).matrix();
      const BodyCentre found =
          computeCentre(ellipsoid(of.centre_mm, of.semi_axes_mm, turn), kCamera);
      EXPECT_LT((found.position_mm - of.centre_mm).norm(), 0.02 * of.semi_axes_mm.x()) << i;
    }
  }
}

TEST(ReferencePoint, ASphereIsOneAndABoxIsNone) {
  const Vec3 centre(0, 0, 1000);
  const BodyCentre ball =
      computeCentre(ellipsoid(centre, {60, 60, 60}, Eigen::Matrix3d::Identity()), kCamera);
  EXPECT_TRUE(ball.sphere);
  EXPECT_LT((ball.position_mm - centre).norm(), 1.0);
  // Edge on: two planes that meet in front. The centre is 50 mm behind the edge.
  const Surface box = surfaceOf([](const Vec2& at) -> std::optional<double> {
    const double x = (at.x() - 160) / 1.2;
    const double y = (at.y() - 120) / 1.2;
    if (std::abs(x) > 50 || std::abs(y) > 35) return std::nullopt;
    return 1000 + std::abs(x);
  });
  const BodyCentre found = computeCentre(box, kCamera);
  EXPECT_FALSE(found.sphere);
  EXPECT_NEAR(found.position_mm.z(), 1050, 25);
}

TEST(ReferencePoint, AFlatThingHasItsCentreOnIt) {
  const Surface card = surfaceOf([](const Vec2& at) -> std::optional<double> {
    if (at.x() < 80 || at.x() > 200 || at.y() < 70 || at.y() > 160) return std::nullopt;
    return 900.0;
  });
  EXPECT_NEAR(computeCentre(card, kCamera).position_mm.z(), 900, 1e-6);
  EXPECT_EQ(computeCentre(surfaceOf([](const Vec2&) { return std::nullopt; }), kCamera).position_mm,
            Vec3::Zero());
}

}  // namespace
}  // namespace hapticast::server
