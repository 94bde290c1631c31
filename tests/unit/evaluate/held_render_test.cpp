// SPDX-License-Identifier: MIT
// The truth of the drawn scenes is checked by other formulas than the ones that draw.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "tests/scenes/held/render.hpp"

namespace hapticast::evaluate::held::test {

namespace {

const server::CameraModel kCamera{300, 300, 160, 120};
const cv::Size kSize(320, 240);

Thing oneOf(const Part& part, const Pose& pose, std::uint8_t id = 1) {
  Thing out;
  out.id = id;
  out.parts = {part};
  out.pose = pose;
  return out;
}

Picture drawn(const std::vector<Thing>& things) {
  const Renderer renderer(kCamera, kSize, Light());
  Picture out = renderer.empty();
  const std::vector<Paint> paints(4);
  for (const Thing& thing : things) renderer.draw(thing, paints, out);
  return out;
}

Pose standing(const Vec3& at_mm) { return {Mat3::Identity(), at_mm}; }

Pose rotated(double angle_rad, const Vec3& at_mm) {
  return {Eigen::AngleAxisd(angle_rad, Vec3(0.3, 0.8, -0.5).normalized()).toRotationMatrix(),
          at_mm};
}

// Nearest root > 0 of a z² + 2 b z + c; 0: none.
double firstRoot(double a, double b, double c) {
  const double rest = b * b - a * c;
  if (rest < 0) return 0.0;
  const double near = (-b - std::sqrt(rest)) / a;
  return near > 0 ? near : 0.0;
}

// Largest difference of the picture's depth from `exact` where both have some, and how many pixels
// only one of them has.
template <class Exact>
void expectDepth(const Picture& picture, const Exact& exact, int most_beside) {
  double worst = 0.0;
  int both = 0;
  int beside = 0;
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) {
      const double z = exact(kCamera.ray(u + 0.5, v + 0.5));
      const bool seen = picture.id.at<uchar>(v, u) != 0;
      if (seen != (z > 0)) ++beside;
      if (!seen || z <= 0) continue;
      ++both;
      worst = std::max(worst, std::abs(double(picture.depth.at<float>(v, u)) - z));
    }
  }
  EXPECT_GT(both, 2000);
  EXPECT_LE(beside, most_beside);
  EXPECT_LT(worst, 0.01);
}

}  // namespace

TEST(HeldRender, DepthOfABallIsItsQuadraticsRoot) {
  const Vec3 at(20, -15, 500);
  const Picture picture =
      drawn({oneOf(makePart(Form::kEllipsoid, {60, 60, 60}, Vec3::Zero(), 0), standing(at))});
  expectDepth(
      picture,
      [&](const Vec3& ray) {
        return firstRoot(ray.squaredNorm(), -ray.dot(at), at.squaredNorm() - 60.0 * 60.0);
      },
      12);
}

TEST(HeldRender, DepthOfATurnedEllipsoidIsItsQuadraticsRoot) {
  const Pose pose = rotated(0.9, {-20, 10, 480});
  const Vec3 axes(80, 40, 55);
  const Picture picture = drawn({oneOf(makePart(Form::kEllipsoid, axes, Vec3::Zero(), 0), pose)});
  expectDepth(
      picture,
      [&](const Vec3& ray) {
        const Vec3 from = pose.in(Vec3::Zero()).cwiseQuotient(axes);
        const Vec3 way = (pose.turn.transpose() * ray).cwiseQuotient(axes);
        return firstRoot(way.squaredNorm(), way.dot(from), from.squaredNorm() - 1.0);
      },
      12);
}

TEST(HeldRender, DepthOfABoxIsThatOfItsPlanes) {
  const Pose pose = rotated(0.6, {10, 0, 420});
  const Vec3 half(60, 45, 30);
  Part part = makePart(Form::kBox, half, Vec3::Zero(), 0);
  part.rounding_mm = 0.0;
  const Picture picture = drawn({oneOf(part, pose)});
  expectDepth(
      picture,
      [&](const Vec3& ray) {
        const Vec3 from = pose.in(Vec3::Zero());
        const Vec3 way = pose.turn.transpose() * ray;
        double enter = 0.0;
        double leave = 1e9;
        for (int i = 0; i < 3; ++i) {
          const double a = (-half[i] - from[i]) / way[i];
          const double b = (half[i] - from[i]) / way[i];
          enter = std::max(enter, std::min(a, b));
          leave = std::min(leave, std::max(a, b));
        }
        return enter < leave ? enter : 0.0;
      },
      12);
}

// A round cone of equal ends is a cylinder with two balls; one that comes in from beyond the
// picture's border, too.
TEST(HeldRender, DepthOfACapsuleIsThatOfItsPieces) {
  const Vec3 a(-60, 20, 450);
  const double radius = 30.0;
  for (const Vec3& b : {Vec3(70, -30, 520), Vec3(500, 300, 380), Vec3(60, 400, 60)}) {
    const Picture picture = drawn({oneOf(makeLimb(a, b, radius, radius, 0), Pose())});
    const Vec3 axis = (b - a).normalized();
    expectDepth(
        picture,
        [&](const Vec3& ray) {
          double nearest_z = 1e9;
          for (const Vec3& end : {a, b}) {
            const double z =
                firstRoot(ray.squaredNorm(), -ray.dot(end), end.squaredNorm() - radius * radius);
            if (z > 0) nearest_z = std::min(nearest_z, z);
          }
          const Vec3 way = ray - ray.dot(axis) * axis;
          const Vec3 off = -a + a.dot(axis) * axis;
          const double z =
              firstRoot(way.squaredNorm(), way.dot(off), off.squaredNorm() - radius * radius);
          const double along = (z * ray - a).dot(axis);
          if (z > 0 && along >= 0 && along <= (b - a).norm()) nearest_z = std::min(nearest_z, z);
          return nearest_z < 1e8 ? nearest_z : 0.0;
        },
        16);
  }
}

// Cases without a closed formula: the pixel's point is on the surface, and the ray is outside of
// the thing all the way to it.
TEST(HeldRender, NothingIsBeforeTheFirstSurface) {
  for (const Part& part : {makePart(Form::kMug, {45, 50, 4}, Vec3::Zero(), 0),
                           makePart(Form::kTube, {20, 90, 0.009}, Vec3::Zero(), 0),
                           makePart(Form::kTube, {20, 90, -0.007}, Vec3::Zero(), 0),
                           makePart(Form::kCylinder, {40, 60, 0}, Vec3::Zero(), 0),
                           makePart(Form::kRoundCone, {45, 80, 15}, Vec3::Zero(), 0)}) {
    const Thing thing = oneOf(part, rotated(0.8, {0, 0, 420}));
    const Picture picture = drawn({thing});
    int seen = 0;
    for (int v = 1; v < kSize.height; v += 7) {
      for (int u = 1; u < kSize.width; u += 7) {
        if (picture.id.at<uchar>(v, u) == 0) continue;
        ++seen;
        const Vec3 ray = kCamera.ray(u + 0.5, v + 0.5);
        const double z = double(picture.depth.at<float>(v, u));
        EXPECT_NEAR(distanceTo_mm(thing, thing.pose.in(z * ray)), 0.0, 2e-3);
        for (double before = z - 1.0; before > 250.0; before -= 1.0)
          ASSERT_GT(distanceTo_mm(thing, thing.pose.in(before * ray)), -0.05) << u << ' ' << v;
      }
    }
    EXPECT_GT(seen, 60);
  }
}

TEST(HeldRender, APixelShowsTheNearerThing) {
  const Thing ball =
      oneOf(makePart(Form::kEllipsoid, {60, 60, 60}, Vec3::Zero(), 0), standing({-20, 0, 500}), 1);
  const Thing limb = oneOf(makeLimb({-120, 0, 520}, {120, 0, 420}, 20, 20, 0), Pose(), 2);
  const Picture both = drawn({ball, limb});
  const Picture other_way = drawn({limb, ball});
  const Picture alone[] = {drawn({ball}), drawn({limb})};
  EXPECT_EQ(cv::countNonZero(both.id != other_way.id), 0);
  int balls = 0;
  int limbs = 0;
  for (int v = 0; v < kSize.height; ++v) {
    for (int u = 0; u < kSize.width; ++u) {
      const float of_ball = alone[0].depth.at<float>(v, u);
      const float of_limb = alone[1].depth.at<float>(v, u);
      const int expected = alone[0].id.at<uchar>(v, u) == 0 && alone[1].id.at<uchar>(v, u) == 0 ? 0
                           : of_ball < of_limb                                                  ? 1
                                                                                                : 2;
      EXPECT_EQ(int(both.id.at<uchar>(v, u)), expected);
      EXPECT_EQ(both.depth.at<float>(v, u), std::min(of_ball, of_limb));
      balls += expected == 1 ? 1 : 0;
      limbs += expected == 2 ? 1 : 0;
    }
  }
  EXPECT_GT(balls, 1000);
  EXPECT_GT(limbs, 1000);
}

TEST(HeldRender, AShadowLiesOnTheSideAwayFromTheLamp) {
  Light light;
  light.towards = Vec3(-0.6, -0.6, -0.5).normalized();  // up to the left, on the camera's side
  Shadows shadows(light, {0, 0, 500});
  shadows.add(
      oneOf(makePart(Form::kEllipsoid, {30, 30, 30}, Vec3::Zero(), 0), standing({0, 0, 450})));
  const Vec3 behind = Vec3(0, 0, 450) - 80.0 * light.towards;
  EXPECT_LT(shadows.litAt(behind), 0.05F);
  EXPECT_GT(shadows.litAt(Vec3(0, 0, 450) + 80.0 * light.towards), 0.95F);
  EXPECT_GT(shadows.litAt(behind + Vec3(90, -60, 0)), 0.95F);
}

}  // namespace hapticast::evaluate::held::test
