// SPDX-License-Identifier: MIT
// The proxy on still reliefs and silhouettes: right, and without lifting.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

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
  std::printf("plane: worst relative error %.2e, %d samples at most\n", worst, table.most_samples);
  EXPECT_LT(worst, 1e-3);
}

/// Lissajous over a sphere of 20 mm, 0..1.5 mm deep.
double errorOnSphere(const std::shared_ptr<const HeightField>& field) {
  Table table;
  table.put(1, field);
  Error error;
  for (int i = 0; i < 40000; ++i) {
    const double t = i * 1e-3;
    const Vec2 at(12.0 * std::sin(1.1 * t), 12.0 * std::sin(1.7 * t + 0.4));
    const double depth = 0.75 + 0.75 * std::sin(2.3 * t);
    const Vec3 outward = Vec3(at.x(), at.y(), std::sqrt(400.0 - at.squaredNorm())) / 20.0;
    const Contact contact = table.touch((20.0 - depth) * outward);
    error.add(contact.displacement_mm, depth * outward);
  }
  return error.relative();
}

/// 255 levels over 30 mm, then a local quadratic fit with Gaussian weights of 3 px: what the
/// server does to 8-bit depth.
HeightOf fitted(const HeightOf& height) {
  return [=](const Vec2& at) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (int v = -9; v <= 9; ++v) {
      for (int u = -9; u <= 9; ++u) {
        const Vec2 there = at + 0.25 * Vec2(u, v);
        if (!cap(there)) continue;
        const double level = std::round(height(there) * 255.0 / 30.0) * 30.0 / 255.0;
        const Eigen::Matrix<double, 6, 1> basis{1.0,         double(u),   double(v),
                                                u * u / 1.0, u * v / 1.0, v * v / 1.0};
        const double weight = std::exp(-0.5 * (u * u + v * v) / 9.0);
        normal += weight * basis * basis.transpose();
        right += weight * level * basis;
      }
    }
    return normal.ldlt().solve(right)(0);
  };
}

TEST(Proxy, ErrorOnTheSphere) {
  const double exact = errorOnSphere(relief(19.0, sphere, cap));
  const double coarse = errorOnSphere(relief(19.0, fitted(sphere), cap));
  std::printf("sphere R20: %.3f %% on exact depth, %.3f %% on fitted 8-bit depth\n", 100.0 * exact,
              100.0 * coarse);
  EXPECT_LT(exact, 0.005);
  EXPECT_LT(coarse, 0.01);
}

// --- silhouettes
// ------------------------------------------------------------------------------------------------

TEST(Proxy, AWallPushesSidewaysAndNeverLifts) {
  for (const double depth_mm : {0.5, 2.0}) {
    Table table;
    table.put(1, relief(15.0, level(kTop_mm), slantedBox()));
    const Contact contact = table.move(ofBox(12.0, 1.3, 5.0), ofBox(10.0 - depth_mm, 1.3, 5.0));
    const Vec3 ideal = ofBox(depth_mm, 0.0, 0.0);
    std::printf("push %.1f mm into a wall: %.4f mm sideways, %.4f up\n", depth_mm,
                contact.displacement_mm.dot(ideal.normalized()), contact.displacement_mm.z());
    EXPECT_LT((contact.displacement_mm - ideal).norm(), 0.05);
    EXPECT_LT(std::abs(contact.displacement_mm.z()), 0.01);
    EXPECT_LT(std::acos(contact.normal.dot(ideal.normalized())), 0.06);
  }
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
  std::printf("along a wall of 17 degrees, 1 mm deep: direction %.2f degrees rms, step %.4f mm\n",
              rms_deg, step);
  EXPECT_LT(rms_deg, 2.0);
  EXPECT_LT(step, 0.02);
}

TEST(Proxy, PressedInsideARimItDoesNotSlipOff) {
  for (const double depth_mm : {1.5, 5.0}) {
    Table table;
    table.put(1, relief(15.0, level(kTop_mm), slantedBox()));
    const Contact contact =
        table.move(ofBox(9.5, 1.0, kTop_mm + 1.0), ofBox(9.5, 1.0, kTop_mm - depth_mm));
    EXPECT_NEAR(contact.displacement_mm.z(), depth_mm, 1e-3);
    EXPECT_LT(contact.displacement_mm.head<2>().norm(), 1e-3);
  }
}

TEST(Proxy, LeavingOverTheRimGivesNoKick) {
  Table table;
  table.put(1, relief(15.0, level(kTop_mm), slantedBox()));
  const double depth_mm = 0.6;
  (void)table.move(ofBox(8.0, 1.0, kTop_mm + 1.0), ofBox(8.0, 1.0, kTop_mm - depth_mm));
  bool was_free = false;
  for (double out = 8.0; out < 12.0; out += 0.02) {
    const Contact contact = table.touch(ofBox(out, 1.0, kTop_mm - depth_mm));
    if (!contact.contact) was_free = true;
    // Never outwards, and once it is off it stays off.
    EXPECT_LT(contact.displacement_mm.dot(ofBox(1.0, 0.0, 0.0)), 1e-3) << out;
    EXPECT_FALSE(was_free && contact.contact) << out;
    EXPECT_TRUE(contact.contact || out >= 9.7) << out;
  }
  EXPECT_TRUE(was_free);
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
