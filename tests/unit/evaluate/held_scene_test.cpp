// SPDX-License-Identifier: MIT
// The scenes of held things: their motion against differences of their poses, what happens in them,
// and what their sensors do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "tests/scenes/held/scene.hpp"

namespace hapticast::evaluate::held::test {

namespace {

constexpr double kStep_s = 1e-4;
const cv::Size kSmall(160, 120);

Scene sceneOf(const std::string& name, std::uint64_t set = 1) {
  for (Scene& scene : heldScenes(set)) {
    if (scene.name == name) return scene;
  }
  throw std::runtime_error("no scene " + name);
}

// Where a point of the thing at rest is at t, by its pose and its bending alone.
Vec3 pointAt(const Object& object, const Vec3& unbent_mm, double t) {
  return object.path.at(t).pose.out(object.placed(unbent_mm, t));
}

double rms(const cv::Mat& values, const cv::Mat& where) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(values, mean, deviation, where);
  return deviation[0];
}

}  // namespace

TEST(HeldScene, VelocitiesAreTheDifferencesOfThePlaces) {
  double fastest = 0.0;
  double bending = 0.0;
  for (const Scene& scene : heldScenes(1)) {
    const Object& object = scene.object;
    for (double t = 0.05; t < scene.duration_s; t += 0.11) {
      for (const Vec3& unbent : {Vec3(0, 0, 0), Vec3(30, 12, 9), Vec3(-35, -14, 16)}) {
        const Vec3 before = pointAt(object, unbent, t - kStep_s);
        const Vec3 after = pointAt(object, unbent, t + kStep_s);
        const Vec3 difference = (after - before) / (2.0 * kStep_s);
        const Vec3 exact = object.velocityAt(pointAt(object, unbent, t), t);
        EXPECT_LT((difference - exact).norm(), 0.02 + 1e-3 * exact.norm())
            << scene.name << ' ' << t;
        fastest = std::max(fastest, exact.norm());
        const Vec3 rigid = object.path.at(t).velocityAt(pointAt(object, unbent, t));
        bending = std::max(bending, (exact - rigid).norm());
      }
    }
  }
  EXPECT_GT(fastest, 150.0);
  EXPECT_GT(bending, 20.0);
}

TEST(HeldScene, ASqueezedBallKeepsItsVolume) {
  const Scene scene = sceneOf("ball_squeezed");
  const auto volume = [&](double t) { return scene.object.at(t).parts.front().size_mm.prod(); };
  EXPECT_NEAR(volume(0.75) / volume(0.0), 1.0, 1e-9);
  EXPECT_LT(scene.object.at(0.75).parts.front().size_mm.x(),
            0.8 * scene.object.at(0.0).parts.front().size_mm.x());
}

TEST(HeldScene, ABentTubesSurfaceFollowsItsMaterial) {
  const Scene scene = sceneOf("tube_bent");
  const Object& object = scene.object;
  // A point of the straight tube's skin stays on the skin, and its paint with it.
  for (const double t : {0.0, 0.7, 1.2, 1.7, 2.1}) {
    const Part part = object.at(t).parts.front();
    for (const double along : {-120.0, -30.0, 60.0, 140.0}) {
      const Vec3 skin(along, 0.6 * part.size_mm.x(), 0.8 * part.size_mm.x());
      const Vec3 now = object.placed(skin, t);
      EXPECT_NEAR(distanceTo_mm(part, now), 0.0, 1e-6) << t;
      EXPECT_LT((textured(part, now) - skin).norm(), 1e-6) << t;
    }
  }
}

// Returns how far the hand's palm, or else the nearest tip of its fingers, is from the object.
double distanceToHand_mm(const Thing& object, const Thing& hand, bool of_palm) {
  double nearest_mm = 1e9;
  for (const Part& part : hand.parts) {
    const bool is_finger = part.group >= 7;
    if (of_palm ? part.group != 0 : !is_finger) continue;
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      if (is_finger && share < 1.0) continue;
      const Vec3 at = hand.pose.out(part.pose.out({0, share * part.size_mm.y(), 0}));
      const double radius_mm = part.size_mm.x() + share * (part.size_mm.z() - part.size_mm.x());
      nearest_mm = std::min(nearest_mm, distanceTo_mm(object, object.pose.in(at)) - radius_mm);
    }
  }
  return nearest_mm;
}

TEST(HeldScene, HandsTouchTheHeldObjectWithoutPenetration) {
  for (const Scene& scene : heldScenes(1)) {
    if (!scene.held_at_start) continue;
    const Thing object = scene.object.at(0.0);
    const Thing hand = handOf(scene.hands.front(), scene, 0.0);
    const double fingers_mm = distanceToHand_mm(object, hand, false);
    EXPECT_LT(std::min(fingers_mm, distanceToHand_mm(object, hand, true)), 4.0) << scene.name;
    EXPECT_GT(fingers_mm, -14.0) << scene.name;
  }
}

TEST(HeldScene, EveryObjectIsSeenAtTheStart) {
  for (const std::uint64_t set : {std::uint64_t{1}, std::uint64_t{7}}) {
    for (const Scene& scene : heldScenes(set)) {
      const Film::Shot shot = Film(scene, kSmall).shoot(0);
      EXPECT_GT(shot.truth.visibleShare(), 0.3) << scene.name << ' ' << set;
      EXPECT_GT(cv::countNonZero(shot.truth.mask()), 30) << scene.name << ' ' << set;
      EXPECT_EQ(shot.frame.color.size(), kSmall);
      EXPECT_EQ(shot.frame.depth.type(), CV_32FC1);
    }
  }
}

TEST(HeldScene, TheBallIsHiddenForTenFramesAndComesBack) {
  const Film film(sceneOf("ball_hidden"), kSmall);
  int hidden = 0;
  for (std::uint64_t i = 0; i < *film.info().frame_count; ++i)
    hidden += film.shoot(i).truth.visibleShare() == 0.0 ? 1 : 0;
  EXPECT_GE(hidden, 10);
  EXPECT_GT(film.shoot(0).truth.visibleShare(), 0.9);
  EXPECT_GT(film.shoot(*film.info().frame_count - 1).truth.visibleShare(), 0.9);
}

TEST(HeldScene, TheMugLeavesThePictureByHalfAndComesBack) {
  for (const std::uint64_t set : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{7}}) {
    const Film film(sceneOf("half_out", set), kSmall);
    const auto atBorder = [](const cv::Mat& mask) {
      return cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1));
    };
    const cv::Mat first = film.shoot(0).truth.mask();
    const cv::Mat half = film.shoot(28).truth.mask();
    EXPECT_EQ(atBorder(first), 0) << set;
    EXPECT_GT(atBorder(half), 8) << set;
    const double left = cv::countNonZero(half) / double(cv::countNonZero(first));
    EXPECT_GT(left, 0.3) << set;
    EXPECT_LT(left, 0.8) << set;
    EXPECT_EQ(atBorder(film.shoot(*film.info().frame_count - 1).truth.mask()), 0) << set;
  }
}

TEST(HeldScene, TheSeedDefinesTheScene) {
  const cv::Mat once = Film(sceneOf("mug_turned"), kSmall).shoot(3).frame.color;
  const cv::Mat again = Film(sceneOf("mug_turned"), kSmall).shoot(3).frame.color;
  const cv::Mat other = Film(sceneOf("mug_turned", 2), kSmall).shoot(3).frame.color;
  EXPECT_EQ(cv::norm(once, again, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(once, other, cv::NORM_L1) / double(once.total()), 15.0);
}

TEST(HeldScene, StructuredLightHasShadowsAndNoise) {
  Scene scene = sceneOf("mug_turned");
  scene.sensing.beside_px = scene.sensing.below_px = 0.0;
  const Film::Shot shot = Film(scene, {640, 480}).shoot(0);
  const cv::Mat measured = shot.frame.depth > 0;
  const cv::Mat table = (shot.truth.id == static_cast<int>(kTable)) & measured;
  const cv::Mat off = shot.frame.depth - shot.truth.depth;
  EXPECT_GT(rms(off, table & (cv::abs(off) < 10)), 0.2);
  EXPECT_LT(rms(off, table & (cv::abs(off) < 10)), 2.5);
  // The projector's shadow: holes on the table and the person beside the arm.
  const cv::Mat behind = (shot.truth.id != static_cast<int>(kHand)) & (shot.truth.depth < 1500);
  const double share = cv::countNonZero(behind & ~measured) / double(cv::countNonZero(behind));
  EXPECT_GT(share, 0.02);
  EXPECT_LT(share, 0.3);
}

TEST(HeldScene, TimeOfFlightMixesRims) {
  Scene scene = sceneOf("mug_lifted");
  scene.sensing.beside_px = scene.sensing.below_px = 0.0;
  const Film::Shot shot = Film(scene, {640, 480}).shoot(25);
  const cv::Mat off = cv::abs(shot.frame.depth - shot.truth.depth);
  const cv::Mat near = (shot.truth.depth < 1500) & (shot.frame.depth > 0);
  EXPECT_GT(cv::countNonZero(near & (off > 15)), 150);  // flying pixels
  EXPECT_LT(cv::countNonZero(near & (off > 15)) / double(cv::countNonZero(near)), 0.05);
}

TEST(HeldScene, EightBitsHoldTheWholeRoom) {
  const Film film(sceneOf("bear_carried"), {640, 480});
  EXPECT_EQ(film.info().depth_kind, server::DepthKind::kHeight);
  EXPECT_FALSE(film.info().camera);
  const Film::Shot shot = film.shoot(0);
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(shot.frame.depth, &low, &high, nullptr, nullptr, shot.truth.mask());
  EXPECT_LT(high - low, 60.0);  // the object takes few of the 255
  EXPECT_GT(low, 100.0);
  cv::minMaxLoc(shot.frame.depth, &low, &high);
  EXPECT_GE(low, 0.0);
  EXPECT_LE(high, 255.0);
}

TEST(HeldScene, AnEstimatorsScaleFlickers) {
  for (const char* name : {"ball_still", "bottle_turned"}) {
    const Film film(sceneOf(name), kSmall);
    std::vector<double> means;
    for (std::uint64_t i = 0; i < 24; ++i) {
      const Film::Shot shot = film.shoot(i);
      cv::Mat table = shot.truth.id == static_cast<int>(kTable);
      means.push_back(cv::mean(shot.frame.depth, table)[0]);
    }
    double mean = 0.0;
    double square = 0.0;
    for (const double value : means) mean += value / 24.0;
    for (const double value : means) square += (value - mean) * (value - mean) / 24.0;
    EXPECT_GT(std::sqrt(square) / mean, 0.01) << name;
    EXPECT_LT(std::sqrt(square) / mean, 0.1) << name;
  }
}

}  // namespace hapticast::evaluate::held::test
