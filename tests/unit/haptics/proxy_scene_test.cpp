// SPDX-License-Identifier: MIT
// The proxy among layers and many objects, and where there is nothing to touch.
#include <gtest/gtest.h>

#include <limits>
#include <span>

#include "tests/unit/haptics/proxy_bench.hpp"

namespace hapticast::client {
namespace {

TEST(Proxy, TwoLayersAreTwoSurfaces) {
  // A step of 10 mm, turned: the near layer ends where it does, the far one goes on 4 mm under it.
  const auto beyond = [](double from_mm) {
    return [=](const Vec2& at) { return (Eigen::Rotation2Dd(-kSlant) * at).x() > from_mm; };
  };
  const auto onNear = [&](const Vec2& at) { return !beyond(0.0)(at); };
  Table table;
  table.put(1, relief(15.0, level(15.0), onNear));
  table.put(1, relief(15.0, level(5.0), beyond(-4.0)));
  table.object(1).layer = 1;
  const Vec3 wall = ofBox(1.0, 0.0, 0.0);
  // Into the corner: the wall pushes aside, the floor up.
  Contact contact = table.move(ofBox(1.0, 0.0, 6.0), ofBox(-0.5, 0.0, 4.6));
  EXPECT_NEAR(contact.displacement_mm.dot(wall), 0.5, 0.05);
  EXPECT_NEAR(contact.displacement_mm.z(), 0.4, 0.01);
  EXPECT_GT(contact.normal.dot(wall), 0.5);
  EXPECT_GT(contact.normal.z(), 0.5);
  EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-9);
  // Out again and onto the near layer, close to its rim.
  (void)table.move(ofBox(-0.5, 0.0, 4.6), ofBox(2.0, 0.0, 7.0));
  (void)table.move(ofBox(2.0, 0.0, 7.0), ofBox(2.0, 0.0, 17.0));
  (void)table.move(ofBox(2.0, 0.0, 17.0), ofBox(-0.5, 0.0, 17.0));
  contact = table.move(ofBox(-0.5, 0.0, 17.0), ofBox(-0.5, 0.0, 13.5));
  EXPECT_NEAR((contact.displacement_mm - Vec3(0.0, 0.0, 1.5)).norm(), 0.0, 1e-3);
  EXPECT_EQ(contact.object, &table.scene.objects[0]);
  EXPECT_LE(table.most_samples, ProxySurface::kSamples + 5);
}

TEST(Proxy, ObjectsThatOverlapShareOneStiffness) {
  Table one;
  one.put(1, relief(15.0, level(10.0)));
  const Vec3 alone_mm = one.move(Vec3(1.0, 1.0, 12.0), Vec3(1.0, 1.0, 7.0)).displacement_mm;
  EXPECT_NEAR(alone_mm.z(), 3.0, 0.01);
  for (const double deeper_mm : {0.0, 0.5, 2.0}) {
    Table table;
    table.put(1, relief(15.0, level(10.0)));
    table.put(2, relief(15.0, level(10.0 - deeper_mm)));
    const Contact contact = table.move(Vec3(1.0, 1.0, 12.0), Vec3(1.0, 1.0, 7.0));
    EXPECT_NEAR((contact.displacement_mm - alone_mm).norm(), 0.0, 1e-9) << deeper_mm;
  }
  // Two roofs' slopes of 27 degrees: the tip leaves both along their ridge, not twice as far.
  Table roofs;
  roofs.put(1, relief(15.0, [](const Vec2& at) { return 10.0 - 0.5 * at.x(); }));
  roofs.put(2, relief(15.0, [](const Vec2& at) { return 10.0 + 0.5 * at.x(); }));
  const Vec3 up_mm = roofs.move(Vec3(0.0, 0.0, 12.0), Vec3(0.0, 0.0, 9.0)).displacement_mm;
  EXPECT_NEAR((up_mm - Vec3(0.0, 0.0, 1.0)).norm(), 0.0, 0.02);
}

TEST(Proxy, ObjectsThatMoveTogetherHaveTheirSpeed) {
  Table roofs;
  roofs.put(1, relief(15.0, [](const Vec2& at) { return 10.0 - 0.5 * at.x(); }));
  roofs.put(2, relief(15.0, [](const Vec2& at) { return 10.0 + 0.5 * at.x(); }));
  (void)roofs.move(Vec3(0.0, 0.0, 12.0), Vec3(0.0, 0.0, 9.0));
  const Vec3 velocity_mm_s(0.0, 0.0, 50.0);
  for (InterpolatedObject& object : std::span(roofs.scene.objects).first(2))
    object.velocity_mm_s = velocity_mm_s;
  const Contact contact = roofs.touch(Vec3(0.0, 0.0, 9.0));
  ASSERT_TRUE(contact.contact);
  EXPECT_NEAR((contact.surface_velocity_mm_s - velocity_mm_s).norm(), 0.0, 1e-9);
}

TEST(Proxy, ManyObjectsShareTheSamples) {
  Table table;
  for (std::uint32_t i = 0; i < kMaxObjects; ++i) {
    table.put(i, relief(12.0, [=](const Vec2& at) { return rough(at) + 0.01 * i; }));
  }
  Table one;
  one.put(1, relief(12.0, rough));
  for (int i = 0; i < 3000; ++i) {
    const double t = 1e-3 * i;
    const Vec3 hip(6.0 * std::sin(9.0 * t), 6.0 * std::cos(7.0 * t),
                   10.2 + 1.2 * std::cos(5.0 * t));
    ASSERT_TRUE(table.touch(hip).displacement_mm.allFinite());
    (void)one.touch(hip);
  }
  EXPECT_LE(table.most_samples, ProxySurface::kSamples + 5);
}

TEST(Proxy, FarObjectsCostNothing) {
  Table table;
  table.put(1, relief(10.0, level(10.0)));
  (void)table.touch({0.0, 0.0, 20.0});
  for (const Vec3& hip : {Vec3(0.0, 0.0, 20.0), Vec3(40.0, 0.0, 5.0), Vec3(0.0, -35.0, -3.0)}) {
    (void)table.touch(hip + Vec3(0.0, 0.0, 30.0));  // over the object to the other side
    (void)table.touch(hip);
    EXPECT_FALSE(table.touch(hip).contact);
    EXPECT_EQ(table.proxies.samplesUsed(), 0);
  }
  // At rest on a still relief: one look to see that there is nothing to do, or none.
  (void)table.move({0.0, 0.0, 12.0}, {1.0, 2.0, 9.0});
  for (int i = 0; i < 50; ++i) (void)table.touch({1.0, 2.0, 9.0});
  EXPECT_LE(table.proxies.samplesUsed(), 1);
}

TEST(Proxy, AnotherWorkspaceIsAnotherPlaceOfThePixels) {
  Table table;
  table.put(1, relief(10.0, level(10.0)));
  Workspace twice;
  twice.width_mm *= 2.0;
  twice.height_mm *= 2.0;
  EXPECT_FALSE(table.touch({15.0, 0.0, 9.0}).contact);
  table.proxies.restart();
  const Contact contact =
      table.proxies.computeContact(table.scene, {15.0, 0.0, 9.0}, twice, kDeepest_mm);
  EXPECT_NEAR(contact.displacement_mm.z(), 1.0, 1e-5);
}

TEST(Proxy, NothingToTouchAndNoNumbers) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Table table;
  EXPECT_FALSE(table.touch({0.0, 0.0, 0.0}).contact);  // no object at all
  table.put(1, nullptr);
  table.put(2, std::make_shared<const HeightField>());
  table.put(3, relief(5.0, level(7.0), [](const Vec2&) { return false; }));
  EXPECT_FALSE(table.move({0.0, 0.0, 12.0}, {0.0, 0.0, -5.0}).contact);
  table.put(4, relief(5.0, level(7.0)));
  ASSERT_FALSE(table.touch({0.0, 0.0, 9.0}).contact);
  EXPECT_TRUE(table.move({0.0, 0.0, 9.0}, {0.0, 0.0, 6.0}).contact);
  for (const double bad : {kNan, 1e300, -1e300, std::numeric_limits<double>::infinity()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 hip(0.0, 0.0, 6.0);
      hip[axis] = bad;
      const Contact contact = table.touch(hip);
      EXPECT_FALSE(std::isnan(contact.displacement_mm.sum())) << bad << ", " << axis;
      EXPECT_FALSE(std::isnan(contact.normal.sum()));
      (void)table.touch({0.0, 0.0, 9.0});
    }
  }
  table.scene.objects[3].position_mm.x() = kNan;
  EXPECT_FALSE(table.touch({0.0, 0.0, 6.0}).contact);
}

TEST(Proxy, TinyAndStripedMasksAreHarmless) {
  const MaskOf masks[] = {
      [](const Vec2& at) { return at.x() > 0.0 && at.x() < 0.25 && at.y() > 0.0 && at.y() < 0.25; },
      [](const Vec2& at) { return std::fmod(at.x() + 100.0, 1.0) < 0.25; },
      [](const Vec2& at) { return std::fmod(at.x() + 100.0, 4.0) < 2.0; }};
  for (const MaskOf& mask : masks) {
    Table table;
    table.put(1, relief(8.0, level(10.0), mask));
    const Wander wander(3);
    for (int i = 0; i < 4000; ++i) {
      const double t = 1e-3 * i;
      const Vec3 hip(7.0 * wander(0, t), 7.0 * wander(1, t), 9.5 + 2.0 * wander(2, t));
      const Contact contact = table.touch(hip);
      ASSERT_TRUE(contact.displacement_mm.allFinite());
      ASSERT_NEAR(contact.normal.norm(), 1.0, 1e-9);
    }
    EXPECT_LE(table.most_samples, ProxySurface::kSamples + 5);
  }
}

}  // namespace
}  // namespace hapticast::client
