// SPDX-License-Identifier: MIT
// The truth of the synthetic scenes against finite differences and geometry done by hand, and the
// rendered frames against the truth.
#include "server/source/synthetic/synthetic_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <random>
#include <string>

#include "server/source/synthetic/synthetic_source.hpp"

namespace hapticast::server {
namespace {

class SyntheticSceneOfKind : public testing::TestWithParam<SceneName> {
 protected:
  [[nodiscard]] SyntheticScene scene() const { return SyntheticScene(GetParam().kind); }
};

INSTANTIATE_TEST_SUITE_P(SyntheticScene, SyntheticSceneOfKind, testing::ValuesIn(kSceneNames),
                         [](const auto& info) { return std::string(info.param.name); });

/// Nominal points well inside the object at an instant.
std::vector<Vec2> pointsInside(const SyntheticScene& scene, double time_s, std::mt19937& random) {
  const SceneInstant instant = scene.at(time_s);
  const PixelRect box = instant.boundingBox();
  std::uniform_real_distribution<double> part(0.1, 0.9);
  std::vector<Vec2> points;
  while (points.size() < 10) {
    const Vec2 px(box.u + part(random) * box.width, box.v + part(random) * box.height);
    const Vec2 nominal = scene.view().workspace.toNominal(px);
    const auto sample = instant.surface(nominal);
    if (sample && sample->gradient.norm() < 3.0) points.push_back(nominal);
  }
  return points;
}

TEST_P(SyntheticSceneOfKind, GradientIsTheDerivativeOfHeight) {
  const SyntheticScene scene = this->scene();
  std::mt19937 random(1);
  constexpr double kStep_mm = 1e-5;
  for (const double t : {0.0, 0.37, 1.9, 3.3}) {
    const SceneInstant instant = scene.at(t);
    for (const Vec2& p : pointsInside(scene, t, random)) {
      const auto height = [&](double dx, double dy) {
        return instant.surface(p + Vec2(dx, dy)).value().height_mm;
      };
      const Vec2 gradient = instant.surface(p).value().gradient;
      const double dx = (height(kStep_mm, 0) - height(-kStep_mm, 0)) / (2 * kStep_mm);
      const double dy = (height(0, kStep_mm) - height(0, -kStep_mm)) / (2 * kStep_mm);
      EXPECT_NEAR(gradient.x(), dx, 1e-6);
      EXPECT_NEAR(gradient.y(), dy, 1e-6);
    }
  }
}

TEST_P(SyntheticSceneOfKind, VelocityAndAccelerationAreDerivativesOfTheCentre) {
  const SyntheticScene scene = this->scene();
  constexpr double kStep_s = 1e-4;
  for (const double t : {0.1, 0.9, 2.31, 4.3}) {  // no impact nearby
    const Motion before = scene.at(t - kStep_s).motion();
    const Motion now = scene.at(t).motion();
    const Motion after = scene.at(t + kStep_s).motion();
    const Vec3 velocity = (after.position_mm - before.position_mm) / (2 * kStep_s);
    const Vec3 acceleration = (after.velocity_mm_s - before.velocity_mm_s) / (2 * kStep_s);
    EXPECT_LT((now.velocity_mm_s - velocity).norm(), 1e-4) << t;
    EXPECT_LT((now.acceleration_mm_s2 - acceleration).norm(), 1e-3) << t;
    EXPECT_NEAR(now.angular_velocity_rad_s, (after.angle_rad - before.angle_rad) / (2 * kStep_s),
                1e-8);
  }
}

TEST_P(SyntheticSceneOfKind, PointMotionIsTheDerivativeOfAMaterialPoint) {
  const SyntheticScene scene = this->scene();
  std::mt19937 random(2);
  constexpr double kStep_s = 1e-4;
  const double t = 2.31;
  const SceneInstant now = scene.at(t);
  for (const Vec2& p : pointsInside(scene, t, random)) {
    const auto hit = now.hit(scene.view().workspace.toImage(p)).value();
    const Vec3 in_body =
        now.body().rotation.transpose() * (hit.position_mm - now.body().position_mm);
    const auto where = [&](double time_s) {
      const BodyState body = scene.at(time_s).body();
      return scene.view()
          .project(body.position_mm + body.rotation * in_body, Vec3::Zero(), Vec3::Zero())
          .position_mm;
    };
    const Vec3 a = where(t - kStep_s);
    const Vec3 b = where(t);
    const Vec3 c = where(t + kStep_s);
    const Motion motion = now.pointMotion(p).value();
    EXPECT_LT((motion.position_mm - b).norm(), 1e-9);
    EXPECT_LT((motion.velocity_mm_s - (c - a) / (2 * kStep_s)).norm(), 1e-4);
    EXPECT_LT((motion.acceleration_mm_s2 - (a - 2 * b + c) / (kStep_s * kStep_s)).norm(), 1e-2);
  }
}

TEST_P(SyntheticSceneOfKind, RepeatsItselfExactlyAfterItsDuration) {
  const SyntheticScene scene = this->scene();
  for (const double t : {0.0, 0.77, 3.1}) {
    const Motion a = scene.at(t).motion();
    const Motion b = scene.at(t + scene.duration_s()).motion();
    EXPECT_LT((a.position_mm - b.position_mm).norm(), 1e-9);
    EXPECT_LT((a.velocity_mm_s - b.velocity_mm_s).norm(), 1e-9);
    EXPECT_LT(
        (scene.at(t).body().rotation - scene.at(t + scene.duration_s()).body().rotation).norm(),
        1e-9);
  }
}

TEST_P(SyntheticSceneOfKind, RenderedDepthAndMaskAreTheTruthAtPixelCentres) {
  SyntheticSource source(GetParam().kind, 5.0, 320, 240);
  const SceneView& view = source.scene().view();
  while (const auto frame = source.read()) {
    const SceneInstant instant = source.scene().at(frame->clip_time_s);
    int differing = 0;
    int inside = 0;
    for (int v = 0; v < 240; ++v) {
      for (int u = 0; u < 320; ++u) {
        // All pixels, so that a bounding box cut too small shows.
        const auto truth = instant.surface(view.workspace.toNominal({u + 0.5, v + 0.5}));
        const bool masked = frame->mask.at<std::uint8_t>(v, u) == 1;
        const float depth_mm = frame->depth.at<float>(v, u);
        inside += masked ? 1 : 0;
        if (masked != truth.has_value()) {
          ++differing;
        } else if (masked) {
          differing += std::abs(view.height_mm(depth_mm) - truth->height_mm) > 2e-5 ? 1 : 0;
          differing += truth->height_mm > 0.0 && truth->height_mm < 30.0 ? 0 : 1;
        } else {
          differing += depth_mm > view.range.far_mm ? 0 : 1;
        }
      }
    }
    ASSERT_EQ(differing, 0) << "frame " << frame->index;
    ASSERT_GT(inside, 1000) << "frame " << frame->index;
  }
}

TEST_P(SyntheticSceneOfKind, TheWholeObjectStaysInThePicture) {
  const SyntheticScene scene = this->scene();
  for (double t = 0.0; t < scene.duration_s(); t += 0.01) {
    const PixelRect box = scene.at(t).boundingBox();
    ASSERT_GT(box.u, 0) << t;
    ASSERT_GT(box.v, 0) << t;
    ASSERT_LT(box.u + box.width, 640) << t;
    ASSERT_LT(box.v + box.height, 480) << t;
  }
}

TEST(SyntheticScene, StillBallIsTheSphereByHand) {
  const SyntheticScene scene(SceneKind::kStill);
  const SceneInstant instant = scene.at(1.0);
  // A sphere of 60 mm at 600 mm, depth 520..620 mm mapped to 30..0 mm.
  EXPECT_NEAR(instant.surface({0.0, 0.0})->height_mm, (620.0 - 540.0) / 100.0 * 30.0, 1e-12);
  EXPECT_NEAR(instant.surface({0.0, 0.0})->gradient.norm(), 0.0, 1e-12);
  // Its outline is where a ray is tangent: sin = 60/600, so tan = 0.1/sqrt(0.99), at 600 px and
  // 0.25 mm/px.
  const double outline_mm = 600.0 * 0.25 * 0.1 / std::sqrt(0.99);
  EXPECT_TRUE(instant.surface({outline_mm - 1e-6, 0.0}));
  EXPECT_FALSE(instant.surface({outline_mm + 1e-6, 0.0}));
  EXPECT_TRUE(instant.surface({0.0, -outline_mm + 1e-6}));
  EXPECT_FALSE(instant.surface({0.0, -outline_mm - 1e-6}));
  // Every visible point lies on the sphere, before its centre.
  for (double u = 262.5; u < 378.0; u += 3.0) {
    const auto hit = instant.hit({u, 240.5});
    ASSERT_TRUE(hit);
    EXPECT_NEAR((hit->position_mm - Vec3(0.0, 0.0, 600.0)).norm(), 60.0, 1e-9);
    EXPECT_LT(hit->position_mm.z(), 600.0);
  }
  EXPECT_EQ(instant.motion().velocity_mm_s, Vec3::Zero());
  EXPECT_EQ(instant.motion().acceleration_mm_s2, Vec3::Zero());
}

TEST(SyntheticScene, GradientPointsUphillInTheNominalFrame) {
  const SceneInstant instant = SyntheticScene(SceneKind::kStill).at(0.0);
  EXPECT_LT(instant.surface({8.0, 0.0})->gradient.x(), 0.0)
      << "right of the top it falls to the right";
  EXPECT_LT(instant.surface({0.0, 8.0})->gradient.y(), 0.0) << "above the top it falls upwards";
}

TEST(SyntheticScene, BounceChangesItsVelocityAtImpactsOnly) {
  const SyntheticScene scene(SceneKind::kBounce);
  ASSERT_EQ(scene.impacts().size(), 6U);
  constexpr double kTiny_s = 1e-9;
  double last_s = -1.0;
  for (const SceneImpact& impact : scene.impacts()) {
    EXPECT_GT(impact.time_s, last_s);
    last_s = impact.time_s;
    const Motion before = scene.at(impact.time_s - kTiny_s).motion();
    const Motion after = scene.at(impact.time_s + kTiny_s).motion();
    EXPECT_LT((after.velocity_mm_s - before.velocity_mm_s - impact.delta_velocity_mm_s).norm(),
              1e-4);
    EXPECT_GT(impact.delta_velocity_mm_s.norm(), 50.0);
    EXPECT_LT((after.position_mm - before.position_mm).norm(), 1e-5);
    EXPECT_NEAR(after.velocity_mm_s.norm(), before.velocity_mm_s.norm(), 1e-4) << "elastic";
  }
  // Elsewhere the velocity has no jump.
  const double largest = scene.at(0.0).motion().acceleration_mm_s2.norm();
  for (double t = 0.0005; t < scene.duration_s(); t += 0.001) {
    const bool at_impact =
        std::any_of(scene.impacts().begin(), scene.impacts().end(),
                    [&](auto& impact) { return std::abs(impact.time_s - t) <= 0.0006; });
    if (at_impact) continue;
    const Vec3 change =
        scene.at(t + 0.0005).motion().velocity_mm_s - scene.at(t - 0.0005).motion().velocity_mm_s;
    ASSERT_LE(change.norm(), 0.001 * largest + 1e-6) << t;
  }
}

TEST(SyntheticScene, BounceFallsDownAndStaysAtItsDistance) {
  const SyntheticScene scene(SceneKind::kBounce);
  for (const double t : {0.2, 1.0, 2.2, 3.9}) {
    const Motion motion = scene.at(t).motion();
    EXPECT_EQ(motion.acceleration_mm_s2.x(), 0.0);
    EXPECT_LT(motion.acceleration_mm_s2.y(), -100.0);
    EXPECT_EQ(motion.velocity_mm_s.z(), 0.0);
  }
}

TEST(SyntheticScene, ApproachStaysOnTheAxisWhileItsOutlineGrows) {
  const SyntheticScene scene(SceneKind::kApproach);
  int last_width = 0;
  for (double t = 0.0; t <= 1.2; t += 0.1) {  // from farthest to nearest
    const Motion motion = scene.at(t).motion();
    EXPECT_EQ(motion.position_mm.head<2>(), Vec2::Zero());
    EXPECT_EQ(motion.velocity_mm_s.head<2>(), Vec2::Zero());
    const PixelRect box = scene.at(t).boundingBox();
    EXPECT_GE(box.width, last_width);
    last_width = box.width;
  }
  EXPECT_GT(last_width, scene.at(0.0).boundingBox().width * 13 / 10);
  EXPECT_GT(scene.at(0.6).motion().velocity_mm_s.z(), 0.0) << "towards the viewer is +z";
  EXPECT_GT(scene.at(0.1).motion().acceleration_mm_s2.z(), 0.0);
}

TEST(SyntheticScene, TumbleTurnsCounterClockwiseWhenItsRateIsPositive) {
  const SyntheticScene scene(SceneKind::kTumble);
  const Motion motion = scene.at(0.0).motion();
  ASSERT_GT(motion.angular_velocity_rad_s, 0.1);
  // A point right of the centre of a body turning counter-clockwise (seen by the viewer) moves up.
  const Vec2 centre = motion.position_mm.head<2>();
  const Vec3 drift = scene.at(0.0).pointMotion(centre)->velocity_mm_s;
  const Vec3 right = scene.at(0.0).pointMotion(centre + Vec2(6.0, 0.0))->velocity_mm_s;
  EXPECT_GT(right.y() - drift.y(), 1.0);
}

TEST(SyntheticScene, OutsideThereIsNoSurface) {
  const SceneInstant instant = SyntheticScene(SceneKind::kStill).at(0.0);
  EXPECT_FALSE(instant.surface({50.0, 50.0}));
  EXPECT_FALSE(instant.pointMotion({50.0, 50.0}));
  EXPECT_FALSE(instant.surface({std::nan(""), 0.0}));
}

TEST(SyntheticScene, ScalesWithThePicture) {
  Workspace small;
  small.width_px = 320;
  small.height_px = 240;
  const auto a = SyntheticScene(SceneKind::kTumble).at(1.3);
  const auto b = SyntheticScene(SceneKind::kTumble, small).at(1.3);
  EXPECT_LT((a.motion().position_mm - b.motion().position_mm).norm(), 1e-9);
  const Vec2 p = a.motion().position_mm.head<2>();
  EXPECT_NEAR(a.surface(p)->height_mm, b.surface(p)->height_mm, 1e-9);
}

TEST(SyntheticSource, AnnouncesTheClip) {
  const SyntheticSource source(SceneKind::kBounce, 50.0);
  EXPECT_EQ(source.info().name, "synthetic:bounce");
  EXPECT_EQ(source.info().width_px, 640);
  EXPECT_EQ(source.info().height_px, 480);
  EXPECT_EQ(source.info().fps, 50.0);
  EXPECT_EQ(source.info().frame_count, 240U);
  EXPECT_FALSE(source.info().live);
  EXPECT_EQ(source.info().depth_kind, DepthKind::kMetric);
  EXPECT_EQ(source.info().camera->fx_px, 600.0);
  EXPECT_LT(source.info().depth_range->near_mm, source.info().depth_range->far_mm);
}

TEST(SyntheticSource, SkipsAndRewinds) {
  SyntheticSource source(SceneKind::kApproach, 10.0, 64, 48);
  const auto first = source.read();
  EXPECT_EQ(first->index, 0U);
  EXPECT_EQ(first->epoch, 0U);
  EXPECT_TRUE(source.skip());
  const auto third = source.read();
  EXPECT_EQ(third->index, 2U);
  EXPECT_DOUBLE_EQ(third->clip_time_s, 0.2);
  while (source.skip()) {
  }
  EXPECT_FALSE(source.read());
  source.rewind();
  const auto again = source.read();
  EXPECT_EQ(again->index, 0U);
  EXPECT_EQ(again->epoch, 1U);
  EXPECT_EQ(cv::norm(again->depth, first->depth, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(again->color, first->color, cv::NORM_INF), 0.0);
}

TEST(SyntheticSource, TextureMovesWithTheBody) {
  SyntheticSource source(SceneKind::kTumble, 25.0);
  cv::Scalar mean;
  cv::Scalar deviation;
  const auto frame = source.read();
  cv::meanStdDev(frame->color, mean, deviation, frame->mask);
  EXPECT_GT(deviation[1], 20.0) << "enough contrast to be tracked";
  // The same material point keeps its colour from frame to frame, up to shading and pixel size.
  const auto next = source.read();
  const SceneInstant a = source.scene().at(frame->clip_time_s);
  const SceneInstant b = source.scene().at(next->clip_time_s);
  const Workspace& workspace = source.scene().view().workspace;
  double moved = 0.0;
  double unmoved = 0.0;
  for (int i = -20; i <= 20; ++i) {
    const Vec2 px = workspace.toImage(a.motion().position_mm.head<2>()) + Vec2(i, i / 2);
    const auto hit = a.hit(px).value();
    const Vec3 in_body = a.body().rotation.transpose() * (hit.position_mm - a.body().position_mm);
    const Vec3 there = b.body().position_mm + b.body().rotation * in_body;
    const Vec2 to = workspace.toImage(
        source.scene().view().project(there, Vec3::Zero(), Vec3::Zero()).position_mm.head<2>());
    const auto green = [](const cv::Mat& image, const Vec2& p) {
      return static_cast<double>(
          image.at<cv::Vec3b>(static_cast<int>(p.y()), static_cast<int>(p.x()))[1]);
    };
    moved += std::abs(green(next->color, to) - green(frame->color, px));
    unmoved += std::abs(green(next->color, px) - green(frame->color, px));
  }
  EXPECT_LT(moved, 0.5 * unmoved);
}

}  // namespace
}  // namespace hapticast::server
