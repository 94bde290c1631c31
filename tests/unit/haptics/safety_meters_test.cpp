// SPDX-License-Identifier: MIT
// The chain's meters against energy that the test sums itself, from the forces that went to the
// device and the true way of its tip.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {
namespace {

/// 5 % or 2 mJ.
double tolerance_mJ(double truth_mJ) { return std::max(2.0, 0.05 * std::abs(truth_mJ)); }

/// Sums the work of what the wall alone would have given, and of all that was sent.
class Book {
 public:
  explicit Book(ChainFixture& rig) : rig_(rig) {}
  void step() {
    const Vec3 before_mm = rig_.device.truePosition_mm();
    rig_.step();
    const Vec3 way_mm = rig_.device.truePosition_mm() - before_mm;
    wall_mJ += wall_N_[kDelay].dot(way_mm);
    all_mJ += all_N_[kDelay].dot(way_mm);
    x_mJ += all_N_[kDelay].x() * way_mm.x();
    for (std::size_t i = kDelay; i > 0; --i) {
      wall_N_[i] = wall_N_[i - 1];
      all_N_[i] = all_N_[i - 1];
    }
    wall_N_[0] = rig_.out.static_force_N;
    all_N_[0] = rig_.out.force_N;
  }
  double wall_mJ = 0.0;
  double all_mJ = 0.0;
  double x_mJ = 0.0;  // of all, along x

 private:
  static constexpr std::size_t kDelay = 1;
  ChainFixture& rig_;
  std::array<Vec3, kDelay + 1> wall_N_{Vec3::Zero(), Vec3::Zero()};
  std::array<Vec3, kDelay + 1> all_N_{Vec3::Zero(), Vec3::Zero()};
};

/// A light hand, 1 N pressed into a wall of 1 N/mm.
void pressIn(ChainFixture& rig) {
  rig.device.reset({0.0, 0.0, 10.0}, Vec3::Zero());
  rig.run(300);
  rig.device.setTarget({0.0, 0.0, -6.0});
  rig.run(1000);
}

TEST(SafetyMeters, WorkOfTheSlewLimitIsNotCountedForTheWall) {
  for (const double frequency_hz : {4.0, 8.0, 16.0}) {
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitZ())}) {
      const PlantProfile profile = omni(1.0, 1);
      SafetyLinks links;
      links.trust = links.tank = links.passivity = links.thermal =
          false;  // only the slew limit acts
      ChainFixture rig(profile, profile, Hand::light(), links);
      pressIn(rig);
      rig.clear();
      const PortWork start = rig.chain.work();
      Book book(rig);
      for (int i = 0; i < 4000; ++i) {
        const bool positive = std::fmod(i * 1e-3 * frequency_hz, 1.0) < 0.5;
        rig.dynamic_N = (positive ? 1.0 : -1.0) * axis;
        book.step();
      }
      ASSERT_GT(rig.count(SafetyAction::kSlew), 100U);
      const PortWork& end = rig.chain.work();
      // Into the wall at 16 Hz a tip moves by few counts at a time: measured 9 and 18 mJ off.
      const bool few_counts = frequency_hz > 8.0 && axis.z() > 0.0;
      const double slack_mJ = few_counts ? 20.0 : 0.0;
      EXPECT_NEAR(end.relative_mJ - start.relative_mJ, book.wall_mJ,
                  tolerance_mJ(book.wall_mJ) + slack_mJ)
          << frequency_hz << " Hz along " << axis.transpose();
      EXPECT_NEAR(end.user_mJ() - start.user_mJ(), book.all_mJ,
                  tolerance_mJ(book.all_mJ) + slack_mJ)
          << frequency_hz << " Hz along " << axis.transpose();
    }
  }
}

TEST(SafetyMeters, AForceThatRampsDownKeepsItsShares) {
  // Epochs that come and go under a large dynamic force: what ramps down was mostly not the wall's.
  const PlantProfile profile = omni(1.0, 1);
  SafetyLinks links;
  links.trust = links.tank = links.passivity = links.thermal = false;
  ChainFixture rig(profile, profile, Hand::light(), links);
  pressIn(rig);
  const PortWork start = rig.chain.work();
  Book book(rig);
  for (int i = 0; i < 4000; ++i) {
    rig.dynamic_N = {i % 200 < 100 ? 2.0 : -2.0, 0.0, 0.0};
    rig.epoch_jump = i % 100 == 50;
    book.step();
  }
  // The wall pushes along z, all that moves the hand along x is the object's.
  const PortWork& end = rig.chain.work();
  EXPECT_GT(book.x_mJ, 10.0);
  EXPECT_NEAR(end.object_mJ - start.object_mJ, book.x_mJ, tolerance_mJ(book.x_mJ));
  EXPECT_NEAR(end.user_mJ() - start.user_mJ(), book.all_mJ, tolerance_mJ(book.all_mJ));
}

/// A stream that is stiff while the hand goes out and soft while it goes in.
struct Pumped {
  double relative_mJ, true_mJ;
  std::uint64_t damped;
};
Pumped pump(bool passivity, double frequency_hz) {
  const PlantProfile profile = omni(0.5, 1);
  SafetyLinks links;
  links.trust = links.tank = false;
  links.passivity = passivity;
  ChainFixture rig(profile, profile, Hand::light(), links);
  pressIn(rig);
  rig.clear();
  const PortWork start = rig.chain.work();
  Book book(rig);
  for (int i = 0; i < 4000; ++i) {
    const double phase = 2.0 * M_PI * frequency_hz * i * 1e-3;
    rig.device.setTarget({0.0, 0.0, -6.0 - 4.0 * std::sin(phase)});
    rig.stiffness_N_mm = std::cos(phase) < 0.0 ? 1.0 : 0.4;
    book.step();
  }
  return {rig.chain.work().relative_mJ - start.relative_mJ, book.all_mJ,
          rig.count(SafetyAction::kPassivity)};
}

TEST(SafetyMeters, AStreamThatPumpsStiffnessIsMeteredAndGivesLittle) {
  for (const double frequency_hz : {2.0, 7.0}) {
    const Pumped free = pump(false, frequency_hz);
    const Pumped damped = pump(true, frequency_hz);
    EXPECT_NEAR(free.relative_mJ, free.true_mJ, tolerance_mJ(free.true_mJ));
    EXPECT_NEAR(damped.relative_mJ, damped.true_mJ, tolerance_mJ(damped.true_mJ));
    // In four seconds; the wall's own damper takes the rest.
    EXPECT_LT(free.true_mJ, 25.0) << frequency_hz;
    EXPECT_LT(damped.true_mJ, 25.0) << frequency_hz;
  }
}

}  // namespace
}  // namespace hapticast::client
