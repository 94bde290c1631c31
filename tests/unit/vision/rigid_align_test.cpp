// SPDX-License-Identifier: MIT
#include "server/vision/motion/rigid_align.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "server/vision/motion/reference_point.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

struct Frame {
  FrameImages view;
  Surface surface;
};

Frame frameOf(const test::BallScene& scene, double u, double v, double closer_mm = 0) {
  Frame out;
  out.view = makeFrameImages(scene.frame(0, u, v, closer_mm), scene.info());
  DepthNoise noise;
  noise.sigma_mm = {0.5};
  out.surface = rawSurface(out.view.depth, out.view.mask * 255, noise);
  return out;
}

Vec3 centreOfBall(const test::BallScene& scene, double u, double v, double closer_mm = 0) {
  const double z = scene.near_mm + scene.bulge_mm - closer_mm;
  const CameraModel c = scene.camera();
  return z * c.ray(u, v);
}

struct Move {
  double du, dv, closer_mm;
};

class RigidAlign : public testing::TestWithParam<Move> {};

TEST_P(RigidAlign, FindsHowTheBallMoved) {
  const test::BallScene scene;
  const Move move = GetParam();
  const Frame before = frameOf(scene, 130, 110);
  const Frame after = frameOf(scene, 130 + move.du, 110 + move.dv, move.closer_mm);
  const RigidTemplate seen(before.view.gray, before.surface, scene.camera());
  const Vec3 pivot = centreOfBall(scene, 130, 110);
  const RigidStep step = seen.find(after.view, pivot, {});
  ASSERT_TRUE(step.reliable);
  const Vec3 truth = centreOfBall(scene, 130 + move.du, 110 + move.dv, move.closer_mm) - pivot;
  const double mm_per_px = pivot.z() / scene.camera().fx_px;
  EXPECT_NEAR(step.shift_mm.x(), truth.x(), 0.08 * mm_per_px);
  EXPECT_NEAR(step.shift_mm.y(), truth.y(), 0.08 * mm_per_px);
  EXPECT_NEAR(step.shift_mm.z(), truth.z(), 0.3);
  EXPECT_LT(Eigen::AngleAxisd(step.rotation).angle(), 0.004);
  // The similarity moves the mask as far as the surface.
  const cv::Vec2d carried = step.similarity * cv::Vec3d(129.5, 109.5, 1.0);
  EXPECT_NEAR(carried[0], 129.5 + move.du, 0.3 + 0.15 * std::abs(move.du));
  EXPECT_NEAR(carried[1], 109.5 + move.dv, 0.3 + 0.15 * std::abs(move.dv));
}

INSTANTIATE_TEST_SUITE_P(Moves, RigidAlign,
                         testing::Values(Move{0, 0, 0}, Move{0.3, -0.2, 0}, Move{3, 2, 1},
                                         Move{-7, 4, -6}, Move{0, 0, 15}, Move{40, -15, 5},
                                         Move{60, 50, 0}));

TEST(RigidAlign, TheOutlineOfABallThatTurnsOnTheSpotStaysWhereItIs) {
  test::BallScene scene;
  const Frame before = frameOf(scene, 130, 110);
  scene.turn_rad = 0.08;  // its paint moves by 3 px in the middle
  const Frame after = frameOf(scene, 130, 110);
  const RigidTemplate seen(before.view.gray, before.surface, scene.camera());
  const RigidStep step = seen.find(after.view, centreOfBall(scene, 130, 110), {});
  ASSERT_TRUE(step.reliable);
  EXPECT_NEAR(Eigen::AngleAxisd(step.rotation).angle(), 0.08, 0.02);
  const cv::Vec2d carried = step.similarity * cv::Vec3d(129.5, 109.5, 1.0);
  EXPECT_NEAR(carried[0], 129.5, 0.8);
  EXPECT_NEAR(carried[1], 109.5, 0.3);
}

TEST(RigidAlign, WithoutTheObjectNothingIsFound) {
  const test::BallScene scene;
  const Frame before = frameOf(scene, 130, 110);
  const RigidTemplate seen(before.view.gray, before.surface, scene.camera());
  FrameImages gone = before.view;
  gone.depth = cv::Mat(gone.depth.size(), CV_32FC1, cv::Scalar(1200));
  gone.gray = cv::Mat(gone.gray.size(), CV_8UC1, cv::Scalar(128));
  const RigidStep step = seen.find(gone, centreOfBall(scene, 130, 110), {});
  EXPECT_FALSE(step.reliable);
  EXPECT_TRUE(step.shift_mm.allFinite() && step.rotation.allFinite());
}

TEST(RigidAlign, NonsenseIsNoMotion) {
  const test::BallScene scene;
  const Frame before = frameOf(scene, 130, 110);
  const RigidTemplate seen(before.view.gray, before.surface, scene.camera());
  RigidStep guess;
  guess.shift_mm = {1e9, -1e9, -1e9};
  EXPECT_TRUE(seen.find(before.view, centreOfBall(scene, 130, 110), guess).shift_mm.allFinite());
  FrameImages holes = before.view;
  holes.depth = cv::Mat::zeros(holes.depth.size(), CV_32FC1);
  EXPECT_FALSE(seen.find(holes, centreOfBall(scene, 130, 110), {}).reliable);
  Surface tiny = before.surface;
  tiny.mask = cv::Mat::zeros(tiny.mask.size(), CV_8UC1);
  tiny.mask.at<uchar>(5, 5) = 255;
  EXPECT_TRUE(RigidTemplate(before.view.gray, tiny, scene.camera()).empty());
  EXPECT_FALSE(RigidTemplate().find(before.view, Vec3(0, 0, 700), {}).reliable);
}

TEST(ReferencePoint, ASphereIsFoundByItsCentre) {
  const test::BallScene scene;
  const Frame frame = frameOf(scene, 190, 100);
  const BodyCentre centre = computeCentre(frame.surface, scene.camera());
  EXPECT_TRUE(centre.sphere);
  EXPECT_LT((centre.position_mm - centreOfBall(scene, 190, 100)).norm(), 0.5);
}

TEST(ReferencePoint, AFlatThingIsWhereItIsSeen) {
  const test::BallScene scene;
  Frame frame = frameOf(scene, 160, 120);
  frame.surface.depth.setTo(700);
  const BodyCentre centre = computeCentre(frame.surface, scene.camera());
  EXPECT_FALSE(centre.sphere);
  EXPECT_NEAR(centre.position_mm.z(), 700, 1e-6);
  EXPECT_NEAR(centre.position_mm.x(), 0, 1.0);
  frame.surface.depth.setTo(0);
  EXPECT_EQ(computeCentre(frame.surface, scene.camera()).position_mm.z(), 0.0);
}

}  // namespace
}  // namespace hapticast::server
