// SPDX-License-Identifier: MIT
// The proxy gives back only what the hand has put in, comes to rest, and repeats itself.
#include <gtest/gtest.h>

#include "tests/unit/haptics/proxy_bench.hpp"

namespace hapticast::client {
namespace {

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

}  // namespace
}  // namespace hapticast::client
