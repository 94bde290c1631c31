// SPDX-License-Identifier: MIT
// The proxy on still reliefs: right, without lifting, without gaining energy.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <random>

#include "tests/unit/client/proxy_bench.hpp"

namespace hapticast::client {
namespace {

constexpr double kSlant = 17.0 * M_PI / 180.0;
constexpr double kTop_mm = 12.0;

/// A flat box of +-10 mm, turned by 17 degrees.
MaskOf slantedBox() {
  return [](const Vec2& at) {
    return (Eigen::Rotation2Dd(-kSlant) * at).cwiseAbs().maxCoeff() < 10.0;
  };
}
/// A point of the box: `out` along the normal of its right wall, `along` the wall.
Vec3 ofBox(double out_mm, double along_mm, double z_mm) {
  const Vec2 at = Eigen::Rotation2Dd(kSlant) * Vec2(out_mm, along_mm);
  return {at.x(), at.y(), z_mm};
}

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

double sphere(const Vec2& at) { return std::sqrt(std::max(0.0, 400.0 - at.squaredNorm())); }
bool cap(const Vec2& at) { return at.norm() < 19.0; }

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

// --- energy
// -----------------------------------------------------------------------------------------------------

double rough(const Vec2& at) {
  return 10.0 + 0.5 * std::sin(2.0 * M_PI * at.x() / 3.0) * std::cos(2.0 * M_PI * at.y() / 3.0);
}

struct Terrain {
  const char* name;
  HeightOf height;
  MaskOf mask;
};
std::vector<Terrain> terrains() {
  return {{"sphere", sphere, cap},
          {"rough", rough, anywhere},
          {"box", level(kTop_mm), slantedBox()},
          {"sinus", [](const Vec2& at) { return 10.0 + std::sin(at.x() * 0.4); }, anywhere}};
}

/// Random but smooth: three sines on each axis about a point of the surface.
class Wander {
 public:
  explicit Wander(std::uint64_t seed) : random_(seed) {
    for (double& f : rate_) f = std::uniform_real_distribution<double>(0.5, 4.0)(random_);
    for (double& p : phase_) p = std::uniform_real_distribution<double>(0.0, 6.28)(random_);
  }
  [[nodiscard]] double operator()(int axis, double t) const {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(3 * axis + k);
      sum += std::sin(2.0 * M_PI * rate_[i] * t + phase_[i]);
    }
    return sum / 3.0;
  }

 private:
  std::mt19937_64 random_;
  std::array<double, 9> rate_{}, phase_{};
};

TEST(Proxy, NoMoveLengthensTheSpring) {
  int contacts = 0;
  int longer = 0;
  for (const Terrain& terrain : terrains()) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Table table;
      table.put(1, relief(20.0, terrain.height, terrain.mask));
      const Wander wander(seed);
      Vec3 proxy_mm = Vec3::Zero();
      bool touched = false;
      for (int i = 0; i < 4000; ++i) {
        const double t = 1e-3 * i;
        const Vec2 at(9.0 * wander(0, t), 9.0 * wander(1, t));
        const Vec3 hip(at.x(), at.y(), terrain.height(at) + 1.5 * wander(2, t));
        const Contact contact = table.touch(hip);
        if (touched && contact.contact) {
          ++contacts;
          const double before = (proxy_mm - hip).norm();
          if (contact.displacement_mm.norm() > before + 1e-3) ++longer;
        }
        touched = contact.contact;
        proxy_mm = hip + contact.displacement_mm;
      }
      ASSERT_LE(table.most_samples, ProxySurface::kSamples + 5) << terrain.name;
    }
  }
  std::printf("%d ticks in contact, the spring lengthened in %d\n", contacts, longer);
  EXPECT_GT(contacts, 20000);
  EXPECT_EQ(longer, 0);
}

TEST(Proxy, ClosedPathsGainNothing) {
  double worst = -1e9;
  for (const Terrain& terrain : terrains()) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Table table;
      table.put(1, relief(20.0, terrain.height, terrain.mask));
      const Wander wander(seed);
      // Once round, beginning and ending in the air; work of the hand against k = 1 N/mm.
      const auto hip = [&](double s) {
        const double t = std::sin(M_PI * s) * std::sin(M_PI * s);
        const Vec2 at(9.0 * wander(0, t), 9.0 * wander(1, t));
        return Vec3(at.x(), at.y(), terrain.height(at) + 3.0 - 4.0 * t + wander(2, t));
      };
      Vec3 last_mm = hip(0.0);
      Vec3 last_N = table.touch(last_mm).displacement_mm;
      double work_Nmm = 0.0;
      double moved_Nmm = 0.0;
      for (int i = 1; i <= 24000; ++i) {
        // There on one way and back on another.
        const double s = i / 24000.0;
        Vec3 now_mm = hip(s);
        now_mm.x() += std::sin(2.0 * M_PI * s);
        const Vec3 now_N = table.touch(now_mm).displacement_mm;
        const double step = -0.5 * (last_N + now_N).dot(now_mm - last_mm);
        work_Nmm += step;
        moved_Nmm += std::abs(step);
        last_mm = now_mm;
        last_N = now_N;
      }
      ASSERT_EQ(last_N.norm(), 0.0);
      if (moved_Nmm > 0.1) worst = std::max(worst, -work_Nmm / moved_Nmm);
    }
  }
  std::printf("closed paths: the surface gains at most %.2e of the work moved\n", worst);
  EXPECT_LE(worst, 1e-4);
}

TEST(Proxy, SettlesUnderAStillHand) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> wide(-8.0, 8.0);
  for (const Terrain& terrain : terrains()) {
    for (int trial = 0; trial < 20; ++trial) {
      Table table;
      table.put(1, relief(20.0, terrain.height, terrain.mask));
      const Vec2 at(wide(random), wide(random));
      const Vec3 hip(at.x(), at.y(), terrain.height(at) - 0.4);
      (void)table.move(hip + Vec3(1.0, 0.5, 2.0), hip, 0.05);
      Vec3 last = Vec3::Zero();
      for (int i = 0; i < 60; ++i) last = table.touch(hip).displacement_mm;
      for (int i = 0; i < 20; ++i) ASSERT_EQ(table.touch(hip).displacement_mm, last);
    }
  }
}

TEST(Proxy, IsRepeatableToTheBit) {
  const auto field = relief(20.0, rough, slantedBox());
  const auto run = [&] {
    Table table;
    table.put(1, field);
    table.object(0).material.static_friction = 0.4;
    table.object(0).material.dynamic_friction = 0.3;
    const Wander wander(5);
    std::vector<Vec3> all;
    for (int i = 0; i < 3000; ++i) {
      const double t = 1e-3 * i;
      const Vec3 hip(11.0 * wander(0, t), 11.0 * wander(1, t), 10.0 + wander(2, t));
      all.push_back(table.touch(hip).displacement_mm);
    }
    return all;
  };
  EXPECT_EQ(run(), run());
}

// --- friction
// ---------------------------------------------------------------------------------------------------

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

TEST_F(Rubbed, CoefficientsAreBounded) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto of = [](double sticking, double sliding) {
    return frictionOf({.static_friction = sticking, .dynamic_friction = sliding});
  };
  EXPECT_EQ(of(kNan, 0.3).sticking, 0.0);
  EXPECT_EQ(of(kNan, 0.3).sliding, 0.0);
  EXPECT_EQ(of(0.5, kNan).sliding, 0.0);
  EXPECT_EQ(of(kInf, kInf).sticking, 10.0);
  EXPECT_EQ(of(0.2, 0.9).sliding, 0.2);  // slipping is never harder than sticking
  EXPECT_EQ(of(-1.0, -2.0).sticking, 0.0);
  // 10: nothing slips before the tip is far aside; nothing breaks.
  table.object(0).material.static_friction = 1e30;
  table.object(0).material.dynamic_friction = 1e30;
  (void)table.move({0.0, 0.0, 11.0}, {0.0, 0.0, 9.9});
  const Contact contact = table.move({0.0, 0.0, 9.9}, {0.9, 0.0, 9.9});
  EXPECT_NEAR((contact.displacement_mm - Vec3(-0.9, 0.0, 0.1)).norm(), 0.0, 1e-3);
  EXPECT_TRUE(table.move({0.9, 0.0, 9.9}, {3.0, 0.0, 9.9}).displacement_mm.allFinite());
}

// --- layers, and what cannot be touched
// ------------------------------------------------------------------------

TEST(Proxy, TwoLayersAreFeltAsTwoSurfaces) {
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
  std::printf("samples at most: 16 objects %d, one %d\n", table.most_samples, one.most_samples);
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
