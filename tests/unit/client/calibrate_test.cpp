// SPDX-License-Identifier: MIT
#include "client/device/calibrate.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/time.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

std::string toText(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(Calibrate, TheGainTakesItsPlaceInTheConfigFile) {
  const TempFolder folder;
  const std::string file = folder.write("a.cfg", "rearm = true\nfalcon-gain=9\nquiet = true");
  storeGain(file, 2999.6);
  EXPECT_EQ(toText(file), "rearm = true\nfalcon-gain = 3000\nquiet = true\n");
  const std::string fresh = folder.write("b.cfg", "quiet = true\n");
  storeGain(fresh, 4100.0);
  EXPECT_EQ(toText(fresh), "quiet = true\nfalcon-gain = 4100\n");
  EXPECT_THROW(storeGain("/nowhere/c.cfg", 1.0), std::runtime_error);
}

/// A grip of 0.1 kg that is made to move by what `strength` makes of the force, and a weight.
Vec3 restingForce_N(double strength, double weight_N) {
  constexpr double kMass_kg = 0.1;
  GripHolder holder;
  Vec3 position_mm(12.0, -7.0, 9.0);
  Vec3 velocity_mm_s = Vec3::Zero();
  for (int i = 0; i < 30'000; ++i) {
    const Vec3 force_N = holder.hold(position_mm);
    if (const auto rest_N = holder.restForce_N()) return *rest_N;
    const Vec3 all_N = strength * force_N - weight_N * Vec3::UnitY() - 2e-3 * velocity_mm_s;
    velocity_mm_s += kTick_s * 1e3 / kMass_kg * all_N;
    position_mm += kTick_s * velocity_mm_s;
  }
  ADD_FAILURE() << "no rest at strength " << strength;
  return Vec3::Zero();
}

TEST(Calibrate, AGripIsHeldAtAnyTrueGain) {
  for (const double strength : {0.4, 1.0, 3.0}) {
    const Vec3 held_N = strength * restingForce_N(strength, 2.0);
    EXPECT_NEAR(held_N.y(), 2.0, 0.02) << strength;
    EXPECT_NEAR(held_N.x(), 0.0, 0.02) << strength;
  }
}

}  // namespace
}  // namespace hapticast::client
