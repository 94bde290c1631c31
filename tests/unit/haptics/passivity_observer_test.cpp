// SPDX-License-Identifier: MIT
// The meters at the ports, the observer, its insurance and the tank, by hand-made ticks.
#include "client/haptics/safety/passivity_observer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/haptics/safety/wall_law.hpp"

namespace hapticast::client {
namespace {

/// A tip that goes up and down by ways, without counts.
class Tip {
 public:
  PortTick upwards(double tip_mm, double surface_mm = 0.0) {
    position_mm_.z() += tip_mm;
    PortTick tick;
    tick.position_mm = position_mm_;
    tick.surface_mm.z() = surface_mm;
    return tick;
  }

 private:
  Vec3 position_mm_ = Vec3::Zero();
};
constexpr double kForce_N = 2.0;
const Vec3 kForce(0.0, 0.0, kForce_N);

TEST(PassivityObserver, MetersTheForceThatActed) {
  for (int delay = 0; delay <= kMostDelay_ticks; ++delay) {
    PassivityObserver ports(delay, 0.0);
    Tip tip;
    ports.sent(kForce, Vec3::Zero());
    for (int age = 0; age <= kMostDelay_ticks; ++age) {
      const double work_mJ = ports.meter(tip.upwards(0.5));
      EXPECT_EQ(work_mJ, age == delay ? 0.5 * kForce_N : 0.0) << "delay " << delay;
      ports.sent(Vec3::Zero(), Vec3::Zero());
    }
    EXPECT_EQ(ports.work().user_mJ(), 0.5 * kForce_N);
  }
}

TEST(PassivityObserver, CountsAreNoWork) {
  // In and out of a spring of 1 N/mm, a tenth of a count per tick: whole counts would be paid in
  // with one force and out with the next, and 1 mm of it would read 0.055 mJ.
  constexpr double kCount_mm = 0.055;
  PassivityObserver ports(0, kCount_mm);
  double force_N = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double true_mm = -0.0055 * (i < 200 ? i : 400 - i);
    PortTick tick;
    tick.position_mm.z() = std::round(true_mm / kCount_mm) * kCount_mm;
    (void)ports.meter(tick);
    force_N = -tick.position_mm.z();
    ports.sent({0.0, 0.0, force_N}, Vec3::Zero());
  }
  EXPECT_GE(ports.work().user_mJ(), 0.0);
  EXPECT_LE(ports.work().user_mJ(), 0.0055 * 1.1);  // what the tick of delay gives at most
}

TEST(PassivityObserver, AWayIsPaidWithTheMeanForceSinceTheLast) {
  PassivityObserver ports(0, 0.0);
  Tip tip;
  for (const double force_N : {1.0, 4.0, 1.0}) {
    ports.sent({0.0, 0.0, force_N}, Vec3::Zero());
    (void)ports.meter(tip.upwards(force_N == 4.0 ? 0.0 : 0.5));
  }
  EXPECT_DOUBLE_EQ(ports.work().user_mJ(), 0.5 * 1.0 + 0.5 * 2.5);
  PortTick elsewhere = tip.upwards(100.0);
  elsewhere.connected = false;
  EXPECT_EQ(ports.meter(elsewhere), 0.0);
}

TEST(SurfaceHistory, GivesTheMotionAtTheMeasuredPosition) {
  SurfaceHistory history;
  for (int i = 1; i <= 20; ++i) {
    history.add({0.0, 0.0, static_cast<double>(i)}, 3);
    EXPECT_EQ(history.present_mm().z(), std::max(0, i - 3));
    EXPECT_EQ(history.coming_mm().z(), i == 1 ? 1 : i == 2 ? 3 : 3 * i - 3);
  }
}

TEST(PassivityObserver, SeparatesTheSurfacesPushFromTheContactsWork) {
  PassivityObserver ports(0, 0.0);
  Tip tip;
  ports.sent(kForce, {0.0, 0.0, 0.5});
  (void)ports.meter(tip.upwards(1.0, 0.8));
  EXPECT_DOUBLE_EQ(ports.work().surface_mJ, 1.5 * 0.8);
  EXPECT_DOUBLE_EQ(ports.work().relative_mJ, 1.5 * 0.2);
  EXPECT_DOUBLE_EQ(ports.work().object_mJ, 0.5);
  EXPECT_DOUBLE_EQ(ports.work().user_mJ(), kForce_N);
}

TEST(PassivityObserver, ObserverCountsStoredEnergyAsNotGenerated) {
  PassivityObserver ports(0, 0.0);
  Tip tip;
  ports.sent(kForce, Vec3::Zero());
  PortTick tick = tip.upwards(-1.0);  // 2 mJ paid in ...
  tick.stored_mJ = 2.0;               // ... and stored
  (void)ports.meter(tick);
  EXPECT_DOUBLE_EQ(ports.generated_mJ(), 0.0);
  tick = tip.upwards(1.0);
  tick.stored_before_mJ = 2.0;
  tick.stored_mJ = 1.0;  // 2 mJ came out, only 1 mJ of it from the spring
  (void)ports.meter(tick);
  EXPECT_DOUBLE_EQ(ports.generated_mJ(), 1.0);
}

TEST(PassivityObserver, ObserverForgetsAndKeepsNoDeepDebt) {
  PassivityObserver ports(0, 0.0);
  Tip tip;
  ports.sent(kForce, Vec3::Zero());
  (void)ports.meter(tip.upwards(2.0));  // 4 mJ
  ports.sent(Vec3::Zero(), Vec3::Zero());
  for (int i = 0; i < 10000; ++i) (void)ports.meter(tip.upwards(0.0));
  EXPECT_NEAR(ports.generated_mJ(), 4.0 * std::exp(-1.0), 0.01);
  ports.sent(kForce, Vec3::Zero());
  for (int i = 0; i < 5; ++i) (void)ports.meter(tip.upwards(-10.0));
  EXPECT_DOUBLE_EQ(ports.generated_mJ(), -2.0);
}

TEST(PassivityObserver, AContactThatBeatsAddsUp) {
  // Each beat generates 1 mJ, and 50 ms without a contact follow.
  PassivityObserver ports(0, 0.0);
  Tip tip;
  for (int beat = 1; beat <= 6; ++beat) {
    ports.sent(kForce, Vec3::Zero());
    (void)ports.meter(tip.upwards(0.5));
    ports.sent(Vec3::Zero(), Vec3::Zero());
    for (int i = 0; i < 50; ++i) (void)ports.meter(tip.upwards(-0.01));
    EXPECT_NEAR(ports.generated_mJ(), beat, 0.03 * beat);
  }
  EXPECT_GT(ports.damping_Ns_m(20.0), 0.0);
}

TEST(PassivityObserver, InsuranceActsAboveItsToleranceOnly) {
  PassivityObserver ports(0, 0.0);
  Tip tip;
  ports.sent(kForce, Vec3::Zero());
  (void)ports.meter(tip.upwards(1.4));  // 2.8 mJ
  EXPECT_EQ(ports.damping_Ns_m(100.0), 0.0);
  (void)ports.meter(tip.upwards(0.15));
  EXPECT_GT(ports.generated_mJ(), 3.0);
  const double excess_mJ = ports.generated_mJ() - 3.0;
  // alpha = E / (T u²): at 0.25 m/s it takes the excess out within a tick.
  const double alpha_Ns_m = ports.damping_Ns_m(250.0);
  EXPECT_NEAR(alpha_Ns_m * 0.25 * 0.25 * 1e-3, excess_mJ * 1e-3, 1e-12);
  EXPECT_EQ(ports.damping_Ns_m(-250.0), alpha_Ns_m);
  EXPECT_EQ(ports.damping_Ns_m(6.0), 5.0);  // never more while the excess is small
  (void)ports.meter(tip.upwards(2.9));
  EXPECT_NEAR(ports.damping_Ns_m(6.0), 5.0 * (ports.generated_mJ() - 3.0) / 3.0, 1e-12);
  (void)ports.meter(tip.upwards(50.0));
  EXPECT_EQ(ports.damping_Ns_m(6.0), 15.0);  // never more at all
  EXPECT_EQ(ports.damping_Ns_m(5.0), 0.0);   // below, the sign of the speed is the count's
}

const Vec3 kRest = Vec3::Zero();

TEST(EnergyTank, IsEmptiedByTheForceAndFilledByTheHandAndByPower) {
  EnergyTank tank{DeviceProfile{}};
  EXPECT_EQ(tank.content_mJ(), 15.0);
  tank.withdraw(10.0, kRest);
  EXPECT_NEAR(tank.content_mJ(), 5.2, 1e-12);
  tank.withdraw(-3.0, kRest);  // the hand pressed
  EXPECT_NEAR(tank.content_mJ(), 8.4, 1e-12);
  tank.withdraw(1000.0, kRest);
  for (int i = 0; i < 3000; ++i) tank.withdraw(0.0, kRest);
  EXPECT_EQ(tank.content_mJ(), 15.0);
}

TEST(EnergyTank, KeepsTheDebtOfEnergyBeyondItsContent) {
  EnergyTank tank{DeviceProfile{}};
  const Vec3 fast_mm_s(500.0, 0.0, 0.0);
  tank.withdraw(20.0, fast_mm_s);
  EXPECT_NEAR(tank.content_mJ(), -4.8, 1e-12);
  EXPECT_EQ(tank.factor(fast_mm_s), 0.0);
  for (int i = 0; i < 23; ++i) tank.withdraw(0.0, fast_mm_s);
  EXPECT_LT(tank.content_mJ(), 0.0);
  tank.withdraw(1000.0, kRest);  // a broken number is no debt for life
  EXPECT_NEAR(tank.content_mJ(), -14.8, 1e-12);
}

/// Takes what the tank has for as long as it lasts; mJ in so many ticks.
double drained_mJ(EnergyTank& tank, int ticks, double hand_mJ = 0.0) {
  double sum_mJ = 0.0;
  for (int i = 0; i < ticks; ++i) {
    const double work_mJ = i % 2 == 0 ? std::max(0.0, tank.content_mJ()) : -hand_mJ;
    tank.withdraw(work_mJ, kRest);
    sum_mJ += work_mJ;
  }
  return sum_mJ;
}

TEST(EnergyTank, ShakesForAMomentOnly) {
  EnergyTank tank{DeviceProfile{}};
  EXPECT_NEAR(drained_mJ(tank, 300), 15.0 + 0.2 * 300, 0.5);  // as ever
  EXPECT_LT(drained_mJ(tank, 9700), 15.0 + 0.04 * 9700 + 15.0);
  // What the hand gives back fills the reserve again: a bouncing surface is not tired out.
  EnergyTank given{DeviceProfile{}};
  double sum_mJ = 0.0;
  for (int i = 0; i < 20; ++i) {
    sum_mJ += drained_mJ(given, 250);
    for (int j = 0; j < 250; ++j, sum_mJ -= 0.5) given.withdraw(-0.5, kRest);
    EXPECT_NEAR(given.content_mJ(), 15.0, 0.21) << i;
  }
  EXPECT_LT(sum_mJ, 500.0);
}

/// The rest of `force_N` with a full (or empty) tank at a lasting velocity.
double factorAt(const Vec3& force_N, const Vec3& velocity_mm_s, bool empty = false) {
  EnergyTank tank{DeviceProfile{}};
  for (int i = 0; i < 100; ++i) tank.withdraw(empty ? 1.0 : 0.0, velocity_mm_s);
  return tank.factor(force_N);
}

TEST(EnergyTank, LimitsOnlyAForceThatDrivesTheHand) {
  const Vec3 force_N(3.0, 0.0, 0.0);
  EXPECT_EQ(factorAt(force_N, {-500.0, 0.0, 0.0}), 1.0);  // it brakes
  EXPECT_EQ(factorAt(force_N, {0.0, 500.0, 0.0}), 1.0);   // across
  EXPECT_EQ(factorAt(force_N, {200.0, 0.0, 0.0}), 1.0);   // 3.75 N for 20 ms can be paid
  EXPECT_NEAR(factorAt(force_N, {500.0, 0.0, 0.0}), 0.5, 1e-9);
  EXPECT_NEAR(factorAt(force_N, {500.0, 900.0, 0.0}), 0.5, 1e-9);  // only along counts
  EXPECT_EQ(factorAt(kRest, force_N), 1.0);
  EXPECT_EQ(factorAt(force_N, {9.0, 0.0, 0.0}, true), 1.0);  // slow
  EXPECT_EQ(factorAt(force_N, {11.0, 0.0, 0.0}, true), 0.0);
}

TEST(EnergyTank, ASingleCountDoesNotShakeIt) {
  EnergyTank tank{DeviceProfile{}};
  const Vec3 force_N(3.0, 0.0, 0.0);
  double low = 1.0;
  double high = 0.0;
  for (int i = 0; i < 300; ++i) {  // 400 mm/s and the noise of counts
    tank.withdraw(0.0, {400.0 + (i % 2 == 0 ? 50.0 : -50.0), 0.0, 0.0});
    if (i < 100) continue;
    low = std::min(low, tank.factor(force_N));
    high = std::max(high, tank.factor(force_N));
  }
  EXPECT_LT(high - low, 0.02);
}

}  // namespace
}  // namespace hapticast::client
