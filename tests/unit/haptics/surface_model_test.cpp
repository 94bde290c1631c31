// SPDX-License-Identifier: MIT
#include "client/haptics/contact/surface_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/frame_builder.hpp"

namespace hapticast::client {
namespace {

constexpr double kRadius_mm = 20.0;

InterpolatedObject standing(const PlayObject& object) {
  InterpolatedObject now;
  now.before = &object;
  now.position_mm = object.motion.position_mm;
  now.angle_rad = object.motion.angle_rad;
  return now;
}

Scene sceneOf(std::initializer_list<InterpolatedObject> objects) {
  Scene scene;
  scene.kind = Lookup::kInterpolated;
  for (const InterpolatedObject& object : objects) scene.objects[scene.object_count++] = object;
  return scene;
}

// --- Eq. 3 on the still ball
// ------------------------------------------------------------------------------------

/// The heights the field got, at the pixel (u, v).
double ballHeight(int u, int v) {
  const Vec2 at = kWorkspace.toNominal({u + 0.5, v + 0.5});
  return static_cast<double>(
      static_cast<float>(std::sqrt(kRadius_mm * kRadius_mm - at.squaredNorm())));
}

class SurfaceModelOfStillBall : public ::testing::TestWithParam<double> {};

TEST_P(SurfaceModelOfStillBall, PerturbedEqualsEq3ByHand) {
  const double z = GetParam();
  const auto field = makeBall(Vec3::Zero(), kRadius_mm, 18.0, kWorkspace);
  const PlayObject object = makeObject(1, field.get(), Vec3::Zero());
  for (const auto& [u, v] : {std::pair{320, 240}, {350, 240}, {320, 270}, {290, 215}, {360, 265}}) {
    const double h = ballHeight(u, v);
    // Eq. 11-12: Sobel over the eight neighbours, / 8, per 0.25 mm; v runs against y.
    const double gx =
        (ballHeight(u + 1, v - 1) + 2 * ballHeight(u + 1, v) + ballHeight(u + 1, v + 1) -
         ballHeight(u - 1, v - 1) - 2 * ballHeight(u - 1, v) - ballHeight(u - 1, v + 1)) /
        8 / 0.25;
    const double gy =
        (ballHeight(u - 1, v - 1) + 2 * ballHeight(u, v - 1) + ballHeight(u + 1, v - 1) -
         ballHeight(u - 1, v + 1) - 2 * ballHeight(u, v + 1) - ballHeight(u + 1, v + 1)) /
        8 / 0.25;
    const double d = h - z;              // Eq. 4
    const double k_h = 30.0 * h / 30.0;  // K h_bar
    Vec3 expected(-d * gx, -d * gy, d);  // d M
    if (d >= k_h) expected = Vec3(-k_h * gx, -k_h * gy, (d - k_h) + k_h);
    const Vec2 at = kWorkspace.toNominal({u + 0.5, v + 0.5});
    const Contact contact = findContact(SurfaceKind::kPerturbed, sceneOf({standing(object)}),
                                        {at.x(), at.y(), z}, kWorkspace);
    ASSERT_TRUE(contact.contact);
    // Heights are sampled in single precision.
    EXPECT_NEAR((contact.displacement_mm - expected).norm(), 0.0, 5e-4);
    EXPECT_NEAR(contact.stiffness_factor, 1 + gx * gx + gy * gy, 1e-4);
    const Contact normal = findContact(SurfaceKind::kNormal, sceneOf({standing(object)}),
                                       {at.x(), at.y(), z}, kWorkspace);
    EXPECT_NEAR((normal.displacement_mm - Vec3(-gx, -gy, 1) * d / (1 + gx * gx + gy * gy)).norm(),
                0.0, 5e-4);
  }
}

// Just under the surface, deep, and under the base plane (d > K h_bar).
INSTANTIATE_TEST_SUITE_P(SurfaceModel, SurfaceModelOfStillBall, ::testing::Values(9.0, 3.0, -2.0));

TEST(SurfaceModel, ThresholdOfEq3FollowsK) {
  const Vec2 g(0.5, -0.2);
  const Vec3 n = Vec3::UnitZ();
  const Vec3 m(-0.5, 0.2, 1.0);
  EXPECT_NEAR((perturbedDisplacement(4.0, 6.0, g, 0.0, 30.0) - 4.0 * n).norm(), 0.0, 1e-12);
  EXPECT_NEAR((perturbedDisplacement(4.0, 6.0, g, 1.0, 30.0) - (3.8 * n + 0.2 * m)).norm(), 0.0,
              1e-12);
  EXPECT_NEAR((perturbedDisplacement(4.0, 6.0, g, 30.0, 30.0) - 4.0 * m).norm(), 0.0, 1e-12);
  EXPECT_NEAR((perturbedDisplacement(8.0, 6.0, g, 30.0, 30.0) - (2.0 * n + 6.0 * m)).norm(), 0.0,
              1e-12);
}

TEST(SurfaceModel, AnAuthorsKOfZeroIsOne) {
  const auto field = makeBall(Vec3::Zero(), kRadius_mm, 19.0, kWorkspace);
  PlayObject object = makeObject(1, field.get(), Vec3::Zero());
  const auto aside = [&](double texture_K_mm) {
    object.material.texture_K_mm = texture_K_mm;
    return findContact(SurfaceKind::kPerturbed, sceneOf({standing(object)}), {8.0, 0.0, 16.0},
                       kWorkspace)
        .displacement_mm.head<2>()
        .norm();
  };
  EXPECT_EQ(aside(0.0), 0.0);
  EXPECT_GT(aside(30.0), 0.5);
  EXPECT_EQ(aside(std::nan("")), aside(30.0));
}

// --- against truth
// ----------------------------------------------------------------------------------------------

TEST(SurfaceModel, ErrorsOnTheSphereAgainstTruth) {
  const auto field = makeBall(Vec3::Zero(), kRadius_mm, 19.0, kWorkspace);
  const PlayObject object = makeObject(1, field.get(), Vec3::Zero());
  const Scene scene = sceneOf({standing(object)});
  double error[2] = {0.0, 0.0};
  double truth = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const double t = i * 1e-3;
    const Vec2 at(12.0 * std::sin(1.1 * t), 12.0 * std::sin(1.7 * t + 0.4));
    const double depth = 0.75 + 0.75 * std::sin(2.3 * t);
    const Vec3 outward = Vec3(at.x(), at.y(), std::sqrt(400.0 - at.squaredNorm())) / kRadius_mm;
    const Vec3 hip = (kRadius_mm - depth) * outward;
    for (const SurfaceKind kind : {SurfaceKind::kPerturbed, SurfaceKind::kNormal}) {
      const Contact contact = findContact(kind, scene, hip, kWorkspace);
      error[static_cast<int>(kind)] += (contact.displacement_mm - depth * outward).squaredNorm();
    }
    truth += depth * depth;
  }
  const double perturbed = std::sqrt(error[0] / truth);
  const double normal = std::sqrt(error[1] / truth);
  EXPECT_LT(normal, 0.06);
  EXPECT_GT(perturbed, 5 * normal);  // as printed, Eq. 3 is no distance
}

TEST(SurfaceModel, NormalIsExactOnAPlane) {
  const auto plane = [](const Vec2& at) { return 12.0 + 0.4 * at.x() - 0.3 * at.y(); };
  const auto field =
      makeField({270, 190, 100, 100}, kWorkspace, plane, [](const Vec2&) { return true; });
  const PlayObject object = makeObject(1, field.get(), Vec3::Zero());
  const Vec3 outward = Vec3(-0.4, 0.3, 1.0).normalized();
  const Vec3 hip = Vec3(2.1, -3.3, plane({2.1, -3.3})) - 1.5 * outward;
  const Contact contact =
      findContact(SurfaceKind::kNormal, sceneOf({standing(object)}), hip, kWorkspace);
  EXPECT_NEAR((contact.displacement_mm - 1.5 * outward).norm(), 0.0, 1e-4);
  EXPECT_NEAR((contact.normal - outward).norm(), 0.0, 1e-4);
  EXPECT_NEAR(contact.depth_mm, 1.5, 1e-4);
  const Contact perturbed =
      findContact(SurfaceKind::kPerturbed, sceneOf({standing(object)}), hip, kWorkspace);
  EXPECT_NEAR(perturbed.depth_mm, 1.5, 1e-4);
  EXPECT_NEAR(perturbed.displacement_mm.norm() / perturbed.depth_mm, perturbed.stiffness_factor,
              1e-4);
}

// --- carried with the object
// ------------------------------------------------------------------------------------

TEST(SurfaceModel, CarriesAReliefAtFortyPixelsPerFrame) {
  const Vec3 from(-5.0, 2.0, 0.0);
  const Vec3 to(5.0, 2.0, 0.0);  // 40 px of 0.25 mm
  const auto a = makeBall(from, kRadius_mm, 19.0, kWorkspace);
  const auto b = makeBall(to, kRadius_mm, 19.0, kWorkspace);
  const auto pool = std::make_unique<FramePool>();
  SceneInterpolator lookup(*pool, Interpolation::kHermite);
  StreamTiming stream;
  stream.first_epoch = 1;
  const Vec3 v(250.0, 0.0, 0.0);
  send(*pool, makeFrame(1, 0, 0.0, {makeObject(1, a.get(), from, v)}));
  send(*pool, makeFrame(1, 1, 0.04, {makeObject(1, b.get(), to, v)}));
  double carried = 0.0;
  double blended = 0.0;
  for (double t = 0.001; t < 0.04; t += 0.002) {
    const InterpolatedObject& object = lookup.at(mediaTime(t), stream).objects[0];
    for (double x = -12.0; x <= 12.0; x += 0.77) {
      const Vec2 centre(-5.0 + 250.0 * t, 2.0);
      const Vec2 at = centre + Vec2(x, 0.5 * x);
      const double truth = std::sqrt(400.0 - (at - centre).squaredNorm());
      const SurfacePoint point = evaluateSurface(object, at, kWorkspace);
      ASSERT_TRUE(point.inside);
      carried = std::max(carried, std::abs(point.sample.height_mm - truth));
      EXPECT_NEAR((point.sample.gradient + (at - centre) / truth).norm(), 0.0, 0.01);
      EXPECT_NEAR(point.shape_rate_mm_s, 0.0, 0.5);
      const Vec2 px = kWorkspace.toImage(at);
      const double pixelwise =
          (1 - t / 0.04) * a->bilinear(px).height_mm + t / 0.04 * b->bilinear(px).height_mm;
      blended = std::max(blended, std::abs(pixelwise - truth));
    }
  }
  EXPECT_LT(carried, 0.1);
  EXPECT_GT(blended, 1.0);
}

TEST(SurfaceModel, TurnsTheReliefAboutTheReferencePoint) {
  // A tilted plate turns a quarter about (3, -2) between the frames; halfway it has turned an
  // eighth.
  const Vec2 pivot(3.0, -2.0);
  const auto tilt = [&](double angle) {
    return [=](const Vec2& at) {
      return 15.0 + 0.4 * (Eigen::Rotation2Dd(-angle) * (at - pivot)).x();
    };
  };
  const double quarter = 0.5 * 3.14159265358979;
  const auto all = [](const Vec2&) { return true; };
  const PixelRect rect{280, 200, 100, 100};
  const auto a = makeField(rect, kWorkspace, tilt(0.2), all);
  const auto b = makeField(rect, kWorkspace, tilt(0.2 + quarter), all);
  PlayObject before = makeObject(1, a.get(), {3.0, -2.0, 1.0});
  PlayObject after = makeObject(1, b.get(), {3.0, -2.0, 1.0});
  before.motion.angle_rad = 0.2;
  after.motion.angle_rad = 0.2 + quarter;
  InterpolatedObject now = standing(before);
  now.after = &after;
  for (const double s : {0.0, 0.25, 0.5, 1.0}) {
    now.blend = s;
    now.angle_rad = 0.2 + s * quarter;
    for (const Vec2& at : {Vec2(3.0, -2.0), Vec2(5.0, 1.0), Vec2(-1.0, -4.0)}) {
      const SurfacePoint point = evaluateSurface(now, at, kWorkspace);
      EXPECT_NEAR(point.sample.height_mm, tilt(now.angle_rad)(at), 1e-4);
      const Vec2 gradient = Eigen::Rotation2Dd(now.angle_rad) * Vec2(0.4, 0.0);
      EXPECT_NEAR((point.sample.gradient - gradient).norm(), 0.0, 1e-4);
    }
  }
}

TEST(SurfaceModel, SurfaceVelocityIsMotionTurnAndChangeOfShape) {
  const auto flat = [](double h) { return [h](const Vec2&) { return h; }; };
  const auto all = [](const Vec2&) { return true; };
  const auto a = makeField({280, 200, 80, 80}, kWorkspace, flat(10.0), all);
  const auto b = makeField({280, 200, 80, 80}, kWorkspace, flat(12.0), all);
  const PlayObject before = makeObject(1, a.get(), Vec3::Zero());
  const PlayObject after = makeObject(1, b.get(), Vec3::Zero());
  InterpolatedObject now = standing(before);
  now.after = &after;
  now.blend = 0.5;
  now.blend_rate_1_s = 25.0;
  now.velocity_mm_s = {7.0, 8.0, 9.0};
  now.angular_velocity_rad_s = 2.0;
  const Contact contact =
      findContact(SurfaceKind::kNormal, sceneOf({now}), {1.0, 3.0, 10.5}, kWorkspace);
  ASSERT_TRUE(contact.contact);
  EXPECT_NEAR(contact.displacement_mm.z(), 0.5, 1e-6);
  EXPECT_NEAR((contact.surface_velocity_mm_s - Vec3(7.0 - 6.0, 8.0 + 2.0, 9.0 + 50.0)).norm(), 0.0,
              1e-6);
  // Against the height itself: its derivative at a still HIP over flat ground.
  now.blend = 0.6;
  EXPECT_NEAR(evaluateSurface(now, {1, 3}, kWorkspace).sample.height_mm, 11.2, 1e-6);
}

// --- who is touched
// ---------------------------------------------------------------------------------------------

TEST(SurfaceModel, DeepestObjectWinsAndMissingReliefsAreSkipped) {
  const auto flat = [](double h) { return [h](const Vec2&) { return h; }; };
  const auto all = [](const Vec2&) { return true; };
  const auto low = makeField({300, 220, 40, 40}, kWorkspace, flat(5.0), all);
  const auto high = makeField({300, 220, 40, 40}, kWorkspace, flat(8.0), all);
  const PlayObject first = makeObject(1, low.get(), Vec3::Zero());
  const PlayObject second = makeObject(2, high.get(), Vec3::Zero());
  const PlayObject hollow = makeObject(3, nullptr, Vec3::Zero());
  const Scene scene = sceneOf({standing(hollow), standing(first), standing(second)});
  const Contact contact = findContact(SurfaceKind::kNormal, scene, {0, 0, 4}, kWorkspace);
  EXPECT_EQ(contact.object, &scene.objects[2]);
  EXPECT_NEAR(contact.depth_mm, 4.0, 1e-6);
  EXPECT_FALSE(findContact(SurfaceKind::kNormal, scene, {0, 0, 8.5}, kWorkspace).contact);
  EXPECT_FALSE(findContact(SurfaceKind::kNormal, scene, {20, 0, 1}, kWorkspace).contact);
  EXPECT_FALSE(findContact(SurfaceKind::kNormal, sceneOf({standing(hollow)}), {0, 0, 4}, kWorkspace)
                   .contact);
  EXPECT_FALSE(findContact(SurfaceKind::kNormal, Scene{}, {0, 0, 4}, kWorkspace).contact);
}

TEST(SurfaceModel, JumpsWithTheSceneAndWhenTheTouchedObjectAppears) {
  const auto field = makeBall(Vec3::Zero(), kRadius_mm, 10.0, kWorkspace);
  const PlayObject object = makeObject(1, field.get(), Vec3::Zero());
  Scene scene = sceneOf({standing(object)});
  EXPECT_FALSE(findContact(SurfaceKind::kNormal, scene, {0, 0, 19}, kWorkspace).jump);
  scene.objects[0].appeared = true;
  EXPECT_TRUE(findContact(SurfaceKind::kNormal, scene, {0, 0, 19}, kWorkspace).jump);
  EXPECT_FALSE(
      findContact(SurfaceKind::kNormal, scene, {0, 0, 21}, kWorkspace).jump);  // not touched
  scene.objects[0].appeared = false;
  scene.jumped = true;
  EXPECT_TRUE(findContact(SurfaceKind::kNormal, scene, {0, 0, 21}, kWorkspace).jump);
}

TEST(SurfaceModel, MissingReliefOfTheNextFrameIsReplacedByThisOne) {
  const auto field = makeBall(Vec3::Zero(), kRadius_mm, 10.0, kWorkspace);
  const PlayObject before = makeObject(1, field.get(), Vec3::Zero());
  const PlayObject after = makeObject(1, nullptr, {4.0, 0.0, 0.0});
  InterpolatedObject now = standing(before);
  now.after = &after;
  now.blend = 0.75;
  now.position_mm = {3.0, 0.0, 0.0};
  const SurfacePoint point = evaluateSurface(now, {3.0, 0.0}, kWorkspace);
  EXPECT_TRUE(point.inside);
  EXPECT_NEAR(point.sample.height_mm, 20.0, 0.01);
}

TEST(SurfaceModel, RandomScenesStayFinite) {
  const auto ball = makeBall({0, 0, -5}, kRadius_mm, 15.0, kWorkspace);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> wide(-1e9, 1e9);
  std::uniform_real_distribution<double> close(-20.0, 20.0);
  const auto draw = [&] { return random() % 10 == 0 ? wide(random) : close(random); };
  constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()};
  int contacts = 0;
  for (int i = 0; i < 50000; ++i) {
    PlayObject before = makeObject(1, ball.get(), {draw(), draw(), draw()});
    PlayObject after = makeObject(1, ball.get(), {draw(), draw(), draw()});
    before.motion.angle_rad = draw();
    before.material.texture_K_mm = draw();
    InterpolatedObject now = standing(before);
    now.position_mm = {draw(), draw(), draw()};
    now.velocity_mm_s = {draw(), draw(), draw()};
    if (random() % 2 == 0) now.after = &after;
    now.blend = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    now.blend_rate_1_s = 25.0;
    Vec3 hip(draw(), draw(), draw());
    if (random() % 20 == 0) hip[static_cast<int>(random() % 3)] = kBad[random() % 2];
    for (const SurfaceKind kind : {SurfaceKind::kPerturbed, SurfaceKind::kNormal}) {
      const Contact contact = findContact(kind, sceneOf({now}), hip, kWorkspace);
      if (!contact.contact) {
        ASSERT_EQ(contact.displacement_mm.norm(), 0.0);
        continue;
      }
      ++contacts;
      if (!hip.allFinite()) continue;  // z = -inf is infinitely deep; the chain refuses such a HIP
      ASSERT_TRUE(contact.displacement_mm.allFinite());
      ASSERT_TRUE(contact.surface_velocity_mm_s.allFinite());
      ASSERT_NEAR(contact.normal.norm(), 1.0, 1e-9);
      ASSERT_GT(contact.displacement_mm.z(), 0.0);
    }
  }
  EXPECT_GT(contacts, 1000);
}

}  // namespace
}  // namespace hapticast::client
