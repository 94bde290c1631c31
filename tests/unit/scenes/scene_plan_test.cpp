// SPDX-License-Identifier: MIT
#include "server/vision/scene_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <random>

#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

Relief tilted(double slope, double noise_mm) {
  Relief out;
  out.rect = {0, 0, 30, 20};
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0.0F, 1.0F);
  for (int i = 0; i < 600; ++i) {
    out.mask.push_back(1);
    out.height_mm.push_back(static_cast<float>(10 + slope * 0.25 * (i % 30)) +
                            static_cast<float>(noise_mm) * noise(random));
  }
  return out;
}

TEST(ScenePlan, ForceDifferenceIsThatAtAFinger) {
  EXPECT_EQ(forceDifference_N(tilted(0.2, 0), tilted(0.2, 0), 0.25, 0.5), 0.0);
  Relief higher = tilted(0.0, 0);
  for (float& h : higher.height_mm) h += 0.1F;
  EXPECT_NEAR(forceDifference_N(tilted(0.0, 0), higher, 0.25, 0.5), 0.05, 1e-6);  // k times 0.1 mm
  EXPECT_GT(forceDifference_N(tilted(0.0, 0), tilted(0.0, 0.05), 0.25, 0.5), 0.04);  // its slopes
  Relief nothing = tilted(0.0, 0);
  nothing.mask.assign(nothing.mask.size(), 0);
  EXPECT_TRUE(std::isinf(forceDifference_N(nothing, nothing, 0.25, 0.5)));
}

/// A plane of which one pixel counts. It rises to the right and downwards.
Relief plane(double slope_u, double slope_v) {
  Relief out;
  out.rect = {0, 0, 5, 5};
  for (int v = -2; v <= 2; ++v) {
    for (int u = -2; u <= 2; ++u) {
      out.mask.push_back(1);
      out.height_mm.push_back(static_cast<float>(10 + 0.25 * (slope_u * u + slope_v * v)));
    }
  }
  return out;
}

TEST(ScenePlan, ATiltAlongEitherAxisHasItsForce) {
  // At 1 mm of penetration: k |(0, 0, 1) - (-g, 0, 1) / (1 + g²)| = k g / sqrt(1 + g²).
  const double force_N = 0.5 * 0.2 / std::sqrt(1.04);
  EXPECT_NEAR(forceDifference_N(plane(0, 0), plane(0.2, 0), 0.25, 0.5), force_N, 1e-5);
  EXPECT_NEAR(forceDifference_N(plane(0, 0), plane(0, 0.2), 0.25, 0.5), force_N, 1e-5);
}

StageReport costing(Stage stage, double cost_N) {
  StageReport out;
  out.costs_N[std::size_t(stage)] = cost_N;
  return out;
}

TEST(ScenePlan, AStageGoesOffWithinTheBudgetOnly) {
  PlanSettings settings;
  settings.error_budget_N = 0.01;
  ScenePlan plan(settings, false);
  EXPECT_TRUE(plan.isOn(Stage::kSmooth));  // not measured yet
  plan.add(costing(Stage::kSmooth, 0.006));
  EXPECT_TRUE(plan.isOn(Stage::kSmooth));
  plan.add(costing(Stage::kSmooth, 0.004));
  EXPECT_FALSE(plan.isOn(Stage::kSmooth));
  plan.add(costing(Stage::kClean, std::numeric_limits<double>::infinity()));
  EXPECT_TRUE(plan.isOn(Stage::kClean));
  plan.add(costing(Stage::kSmooth, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_TRUE(plan.isOn(Stage::kSmooth));
}

TEST(ScenePlan, AtRestAllStagesAreOffExceptTheAuthorsChoices) {
  ScenePlan plan({}, true);
  EXPECT_FALSE(plan.isOn(Stage::kSegment));
  EXPECT_TRUE(plan.isOn(Stage::kMotion));
  plan.setResting(true);
  for (const PlanLine& line : plan.lines()) EXPECT_FALSE(line.on) << line.why;
  plan.setResting(false);
  EXPECT_TRUE(plan.isOn(Stage::kMotion));

  PlanSettings forced;
  forced.forced[std::size_t(Stage::kMotion)] = true;
  forced.forced[std::size_t(Stage::kSmooth)] = false;
  ScenePlan overruled(forced, false);
  overruled.setResting(true);
  EXPECT_TRUE(overruled.isOn(Stage::kMotion));
  EXPECT_FALSE(overruled.isOn(Stage::kSmooth));
  EXPECT_EQ(overruled.lines()[std::size_t(Stage::kMotion)].why, "the author's choice");

  PlanSettings all;
  all.everything = true;
  ScenePlan everything(all, true);
  everything.setResting(true);
  for (const PlanLine& line : everything.lines()) EXPECT_TRUE(line.on);
}

class CountingClock final : public Clock {
 public:
  [[nodiscard]] LocalTime now() const noexcept override {
    return localTime(1e-3 * static_cast<double>(++calls_));
  }

 private:
  mutable int calls_ = 0;
};

// Exact depth needs neither cleaning nor smoothing, and a scene that stops moving nothing at all,
// until it moves again.
TEST(ScenePlan, FollowsASceneThatStopsAndMovesAgain) {
  const test::BallScene scene;
  const CountingClock clock;
  VisionSettings settings;
  settings.depth_range = DepthRange{650, 850};
  Vision vision(scene.info(), settings, &clock);
  const auto isOn = [&](Stage stage) {
    return vision.plan().begin()->second[static_cast<std::size_t>(stage)].on;
  };
  double u = 120;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const bool moves = i < 20 || i >= 50;
    if (moves) u += 1.5;
    (void)vision.push(scene.frame(i, u, 120), mediaTime(double(i) / 25));
    EXPECT_FALSE(isOn(Stage::kSegment));
    EXPECT_FALSE(isOn(Stage::kClean));
    if (i == 10 || i == 55) {
      EXPECT_TRUE(isOn(Stage::kMotion));
      EXPECT_TRUE(isOn(Stage::kHeights));
    }
    if (i == 45) {
      EXPECT_FALSE(isOn(Stage::kMotion));
      EXPECT_FALSE(isOn(Stage::kHeights));
      const PlanLine motion = vision.plan().begin()->second[std::size_t(Stage::kMotion)];
      EXPECT_GT(motion.saves_ms, 0.0);
      EXPECT_EQ(motion.costs_N, 0.0);
    }
  }
}

// Two balls before one wall, cut out by the band method.
RgbdFrame twoBalls(const test::BallScene& scene, std::uint64_t i, const Vec2& one,
                   const Vec2& other) {
  RgbdFrame frame = scene.frame(i, one.x(), one.y());
  const RgbdFrame second = scene.frame(i, other.x(), other.y());
  second.color.copyTo(frame.color, second.mask);
  second.depth.copyTo(frame.depth, second.mask);
  frame.mask.release();
  return frame;
}

// An object at rest gets no stages while another one moves, and gets them when it moves itself.
TEST(ScenePlan, AnObjectAtRestIsLeftOutWhileAnotherMoves) {
  const test::BallScene scene;
  VisionSettings settings;
  settings.object_points = {{{80, 120}}, {{200, 120}}};
  settings.depth_range = DepthRange{650, 850};
  Vision vision(scene.info(), settings);
  Vec2 still(80, 120);
  double moving_x = 200;
  std::vector<VisionResult> results;
  for (std::uint64_t i = 0; i < 90; ++i) {
    moving_x = 200 + 25 * std::sin(0.1 * double(i));
    if (i >= 60) still.y() += 1.0;
    auto result =
        vision.push(twoBalls(scene, i, still, {moving_x, 120}), mediaTime(double(i) / 25));
    if (result) results.push_back(std::move(*result));
    if (i != 55 && i != 75) continue;
    const auto plans = vision.plan();
    ASSERT_EQ(plans.size(), 2U);
    for (const Stage stage : {Stage::kSegment, Stage::kMotion, Stage::kHeights}) {
      EXPECT_EQ(plans.begin()->second[std::size_t(stage)].on, i == 75) << i;
      EXPECT_TRUE(plans.rbegin()->second[std::size_t(stage)].on) << i;
    }
  }
  const HapticFrame& rests = results[50].frame;
  EXPECT_EQ(rests.objects[0].motion.velocity_mm_s.norm(), 0.0);
  EXPECT_EQ(rests.objects[0].changed_in_frame, results[45].frame.objects[0].changed_in_frame);
  EXPECT_NEAR(rests.objects[1].motion.velocity_mm_s.x(), 2.5 * std::cos(5.0) * 25 * 0.5, 1.0);
  EXPECT_NEAR(results[80].frame.objects[0].motion.velocity_mm_s.y(), -25 * 0.5, 0.6);
}

// A ball whose lower part sways although its outline rests and drifts slowly.
RgbdFrame swaying(const test::BallScene& scene, std::uint64_t i, double sway_px) {
  RgbdFrame frame = scene.frame(i, 130 + 0.5 * double(i), 120);
  const double shift = sway_px * std::sin(2 * CV_PI * double(i) / 16);
  const cv::Rect part(95, 125, 100, 25);
  cv::Mat moved;
  cv::warpAffine(frame.color(part), moved, cv::Matx23d(1, 0, shift, 0, 1, 0), part.size(),
                 cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  moved.copyTo(frame.color(part), frame.mask(part));
  return frame;
}

TEST(ScenePlan, ADeformingObjectHasAGridAndARigidBodyNone) {
  const test::BallScene scene;
  for (const double sway_px : {0.0, 4.0}) {
    VisionSettings settings;
    settings.map_range = DepthRange{650, 850};
    Vision vision(scene.info(), settings);
    std::size_t grids = 0;
    double strongest_mm_s2 = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
      const auto result = vision.push(swaying(scene, i, sway_px), mediaTime(double(i) / 25));
      if (!result || result->frame.objects.at(0).grid == nullptr) continue;
      ++grids;
      for (const Eigen::Vector3f& a : result->frame.objects[0].grid->acceleration_mm_s2)
        strongest_mm_s2 = std::max(strongest_mm_s2, double(a.norm()));
    }
    const bool sways = sway_px > 0;
    EXPECT_EQ(vision.plan().begin()->second[std::size_t(Stage::kGrid)].on, sways);
    if (sways) {
      EXPECT_GT(grids, 40U);
      // sway x 0.5 mm/px x (2 pi 25/16)², of which the rigid alignment takes a part
      const double truth_mm_s2 = 4 * 0.5 * std::pow(2 * CV_PI * 25 / 16, 2);
      EXPECT_GT(strongest_mm_s2, 0.3 * truth_mm_s2);
      EXPECT_LT(strongest_mm_s2, 1.2 * truth_mm_s2);
    } else {
      EXPECT_EQ(grids, 0U);
    }
  }
}

TEST(ScenePlan, EverythingSendsEveryHeight) {
  const test::BallScene scene;
  for (const bool everything : {false, true}) {
    VisionSettings settings;
    settings.plan.everything = everything;
    Vision vision(scene.info(), settings);
    for (std::uint64_t i = 0; i < 10; ++i)
      (void)vision.push(scene.frame(i, 160, 120), mediaTime(double(i) / 25));
    const std::vector<VisionResult> rest = vision.flush();
    const HapticObject& object = rest.back().frame.objects.at(0);
    EXPECT_EQ(object.changed_in_frame == rest.back().frame.id, everything);
  }
}

TEST(ScenePlan, LowLatencyWaitsForOneFrame) {
  const test::BallScene scene;
  VisionSettings settings;
  settings.low_latency = true;
  Vision vision(scene.info(), settings);
  EXPECT_EQ(vision.description().pipeline_latency, fromSeconds(0.04));
  EXPECT_FALSE(vision.push(scene.frame(0, 100, 120), mediaTime(0)).has_value());
  Motion motion;
  for (std::uint64_t i = 1; i < 12; ++i) {
    const double t = double(i) / 25;
    const auto result = vision.push(scene.frame(i, 100 + 60 * t * t, 120), mediaTime(t));
    ASSERT_TRUE(result.has_value());
    motion = result->frame.objects.at(0).motion;
  }
  EXPECT_NEAR(motion.acceleration_mm_s2.x(), 120 * 0.5, 10);
}

}  // namespace
}  // namespace hapticast::server
