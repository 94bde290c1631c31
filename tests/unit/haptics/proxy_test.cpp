// SPDX-License-Identifier: MIT
// The proxy on still reliefs and silhouettes. Its error on a sphere, in pushes into walls and at
// rims is measured by hapticast-evaluate accuracy.
#include <gtest/gtest.h>

#include "tests/unit/haptics/proxy_bench.hpp"

namespace hapticast::client {
namespace {

TEST(Proxy, IsExactOnAPlane) {
  const auto plane = [](const Vec2& at) { return 12.0 + 0.4 * at.x() - 0.3 * at.y(); };
  const Vec3 outward = Vec3(-0.4, 0.3, 1.0).normalized();
  Table table;
  table.put(1, relief(15.0, plane));
  double worst = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const double t = 1e-3 * i;
    const Vec2 at(8.0 * std::sin(2.0 * t), 8.0 * std::sin(3.1 * t));
    const double depth = 1.0 - 1.2 * std::cos(5.0 * t);
    const Contact contact = table.touch(Vec3(at.x(), at.y(), plane(at)) - depth * outward);
    if (depth < 0.05) continue;
    ASSERT_TRUE(contact.contact);
    worst = std::max(worst, (contact.displacement_mm - depth * outward).norm() / depth);
    ASSERT_NEAR((contact.normal - outward).norm(), 0.0, 1e-4);
    ASSERT_NEAR(contact.depth_mm, contact.displacement_mm.norm(), 1e-6);
    ASSERT_EQ(contact.object, &table.scene.objects[0]);
    ASSERT_EQ(contact.stiffness_factor, 1.0);
  }
  EXPECT_LT(worst, 1e-3);
}

TEST(Proxy, FollowsASlantedWallSmoothly) {
  Table table;
  table.put(1, relief(15.0, level(kTop_mm), slantedBox()));
  (void)table.move(ofBox(12.0, -6.0, 5.0), ofBox(9.0, -6.0, 5.0));
  const Vec3 outwards = ofBox(1.0, 0.0, 0.0);
  double squared = 0.0;
  double step = 0.0;
  Vec3 last = Vec3::Zero();
  const int ticks = 1200;  // 1 cm/s
  for (int i = 0; i < ticks; ++i) {
    const Contact contact = table.touch(ofBox(9.0, -6.0 + 0.01 * i, 5.0));
    ASSERT_TRUE(contact.contact);
    const double angle =
        std::acos(std::clamp(contact.displacement_mm.normalized().dot(outwards), -1.0, 1.0));
    squared += angle * angle;
    // At first it leaves the place where it has settled while being pushed in.
    if (i > 20) step = std::max(step, (contact.displacement_mm - last).norm());
    last = contact.displacement_mm;
    ASSERT_LT(std::abs(contact.displacement_mm.z()), 0.01);
  }
  const double rms_deg = std::sqrt(squared / ticks) * 180.0 / M_PI;
  EXPECT_LT(rms_deg, 2.0);
  EXPECT_LT(step, 0.02);
}

TEST(Proxy, LiftedOverTheTopOfAWallItIsFreeWithoutBeingLifted) {
  Table table;
  table.put(1, relief(15.0, level(kTop_mm), slantedBox()));
  (void)table.move(ofBox(12.0, 1.0, 8.0), ofBox(9.0, 1.0, 8.0));
  for (double z = 8.0; z < 13.0; z += 0.02) {
    const Contact contact = table.touch(ofBox(9.0, 1.0, z));
    ASSERT_LT(std::abs(contact.displacement_mm.z()), 1e-6);
    ASSERT_EQ(contact.contact, z < kTop_mm) << z;
  }
}

TEST(Proxy, NothingIsPassedByAFastHand) {
  // 1 m/s into the wall, and down onto the top of a ridge of two pixels.
  Table table;
  table.put(1, relief(15.0, level(kTop_mm), slantedBox()));
  const Contact wall = table.move(ofBox(15.0, 0.0, 5.0), ofBox(5.0, 0.0, 5.0), 1.0);
  EXPECT_NEAR((wall.displacement_mm - ofBox(5.0, 0.0, 0.0)).norm(), 0.0, 0.15);
  Table ridge;
  ridge.put(1, relief(10.0, [](const Vec2& at) { return std::abs(at.x()) < 0.25 ? 9.0 : 5.0; }));
  const Contact beside = ridge.move({-5.0, 0.0, 7.0}, {5.0, 0.0, 7.0}, 1.0);
  EXPECT_LT(beside.displacement_mm.x(), -4.0);
}

}  // namespace
}  // namespace hapticast::client
