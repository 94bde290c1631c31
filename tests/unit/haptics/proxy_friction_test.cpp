// SPDX-License-Identifier: MIT
// Coulomb friction at the proxy.
#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "tests/unit/haptics/proxy_bench.hpp"

namespace hapticast::client {
namespace {

class Rubbed : public ::testing::Test {
 protected:
  Rubbed() {
    table.put(1, relief(20.0, level(10.0), slantedBox()));
    table.object(0).material.static_friction = 0.5;
    table.object(0).material.dynamic_friction = 0.3;
  }
  Table table;
};

TEST_F(Rubbed, SticksUpToTheStaticCoefficientAndSlipsAtTheDynamicOne) {
  (void)table.move({0.0, 0.0, 11.0}, {0.0, 0.0, 9.0});
  double breakaway = 0.0;
  double slip = 0.0;
  for (double x = 0.0; x < 4.0; x += 0.005) {
    const Contact contact = table.touch({x, 0.0, 9.0});
    const double ratio = -contact.displacement_mm.x() / contact.displacement_mm.z();
    breakaway = std::max(breakaway, ratio);
    slip = ratio;
    ASSERT_NEAR(contact.normal.z(), 1.0, 1e-6);  // the surface's, not the force's
  }
  EXPECT_NEAR(breakaway, 0.5, 0.01);
  EXPECT_NEAR(slip, 0.3, 0.003);
  // Back again: it sticks first.
  double back = 0.0;
  for (double x = 4.0; x > 2.0; x -= 0.005) {
    const Contact contact = table.touch({x, 0.0, 9.0});
    back = std::max(back, contact.displacement_mm.x() / contact.displacement_mm.z());
  }
  EXPECT_GT(back, 0.29);
  EXPECT_LT(back, 0.51);
}

TEST_F(Rubbed, HoldsOnAWallToo) {
  Table wall;
  wall.put(1, relief(20.0, level(10.0), [](const Vec2& at) { return at.x() < 10.0; }));
  wall.object(0).material = table.object(0).material;
  (void)wall.move({12.0, 0.0, 5.0}, {9.0, 0.0, 5.0});
  for (const Vec3& along : {Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, -1.0)}) {
    double breakaway = 0.0;
    double slip = 0.0;
    for (double way = 0.0; way < 3.0; way += 0.005) {
      const Contact contact = wall.touch(Vec3(9.0, 0.0, 5.0) + way * along);
      slip = -contact.displacement_mm.dot(along) / contact.displacement_mm.x();
      breakaway = std::max(breakaway, slip);
    }
    EXPECT_NEAR(breakaway, 0.5, 0.01);
    EXPECT_NEAR(slip, 0.3, 0.006);
    (void)wall.move(Vec3(9.0, 0.0, 5.0) + 3.0 * along, {12.0, 0.0, 5.0});
    (void)wall.move({12.0, 0.0, 5.0}, {9.0, 0.0, 5.0});
  }
}

Friction given(std::optional<double> sticking, std::optional<double> sliding) {
  Material material;
  material.static_friction = sticking;
  material.dynamic_friction = sliding;
  return toFriction(material);
}

TEST(Friction, TheViewersFrictionFillsGapsOfTheAuthorAndZeroIsAValue) {
  EXPECT_EQ(given({}, {}).sticking, kDefaultFriction);
  EXPECT_EQ(given({}, {}).sliding, kDefaultFriction);
  EXPECT_EQ(given(0.0, 0.0).sticking, 0.0);
  EXPECT_EQ(given(0.0, 0.0).sliding, 0.0);
  // One alone says both: a surface that sticks and then slides as on ice is nobody's wish.
  EXPECT_EQ(given(0.5, {}).sliding, 0.5);
  EXPECT_EQ(given({}, 0.3).sticking, 0.3);
}

TEST_F(Rubbed, CoefficientsAreBounded) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto of = [](double sticking, double sliding) { return given(sticking, sliding); };
  EXPECT_EQ(of(kNan, 0.3).sticking, 0.0);
  EXPECT_EQ(of(kNan, 0.3).sliding, 0.0);
  EXPECT_EQ(of(0.5, kNan).sliding, 0.0);
  EXPECT_EQ(of(kInf, kInf).sticking, 1.5);
  EXPECT_EQ(of(0.2, 0.9).sliding, 0.2);  // slipping is never harder than sticking
  EXPECT_EQ(of(-1.0, -2.0).sticking, 0.0);
  // It slips at the most there is; nothing breaks.
  table.object(0).material.static_friction = 1e30;
  table.object(0).material.dynamic_friction = 1e30;
  (void)table.move({0.0, 0.0, 11.0}, {0.0, 0.0, 9.9});
  const Contact contact = table.move({0.0, 0.0, 9.9}, {0.9, 0.0, 9.9});
  EXPECT_NEAR((contact.displacement_mm - Vec3(-0.15, 0.0, 0.1)).norm(), 0.0, 1e-3);
  EXPECT_TRUE(table.move({0.9, 0.0, 9.9}, {3.0, 0.0, 9.9}).displacement_mm.allFinite());
}

}  // namespace
}  // namespace hapticast::client
