// SPDX-License-Identifier: MIT
#include "client/haptics/safety.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

#include "unit/client/rig.hpp"

namespace hapticast::client {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

DeviceProfile omni(double stiffness_N_mm, int delay_ticks, double friction_N = 0.0) {
  DeviceProfile profile;
  profile.stiffness_N_mm = stiffness_N_mm;
  profile.delay_ticks = delay_ticks;
  profile.friction_N = friction_N;
  return profile;
}

/// A chain that is armed and faded in, out of contact.
SafetyChain armedChain(const DeviceProfile& profile) {
  SafetyChain chain(profile);
  SafetyInput air;
  air.touchable = true;
  for (int i = 0; i < 250; ++i) (void)chain.step(air);
  return chain;
}

SafetyInput pressed(double depth_mm, double stiffness_N_mm = 0.5) {
  SafetyInput input;
  input.touchable = true;
  input.contact = true;
  input.displacement_mm = {0.0, 0.0, depth_mm};
  input.stiffness_N_mm = stiffness_N_mm;
  return input;
}

/// Presses gently (a depth no jump) until the chain rests; returns the last output.
SafetyOutput settled(SafetyChain& chain, SafetyInput input) {
  SafetyOutput out;
  const Vec3 whole_mm = input.displacement_mm;
  for (int i = 1; i <= 60; ++i) {
    input.displacement_mm = whole_mm * std::min(1.0, i / 30.0);
    out = chain.step(input);
  }
  return out;
}

TEST(SafetyChain, ConstantsOfTheWallLaw) {
  const double expected[] = {10.0, 5.08, 1.92, 1.04, 0.66, 0.457};
  for (int d = 0; d <= 5; ++d) {
    EXPECT_NEAR(stiffnessLimit_N_mm(omni(1.0, d)), expected[d], 0.01) << d;
  }
  EXPECT_DOUBLE_EQ(wallLead_s(1), 2.4e-3);
  EXPECT_DOUBLE_EQ(wallLead_s(-3), 1.2e-3);
  EXPECT_DOUBLE_EQ(wallLead_s(99), 8.0e-3);
  EXPECT_DOUBLE_EQ(wallDamping_Ns_m(0.5, 2.4e-3), 2.2);
}

TEST(SafetyChain, RestingForceIsStiffnessTimesDisplacement) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  input.displacement_mm = {0.6, 0.0, 1.6};  // spring along the displacement, not along the normal
  const SafetyOutput out = settled(chain, input);
  EXPECT_NEAR((out.force_N - Vec3(0.3, 0.0, 0.8)).norm(), 0.0, 1e-12);
  EXPECT_EQ(out.interferences, 0u);
}

TEST(SafetyChain, DampsAlongTheNormalOnlyAndNeverPulls) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  (void)settled(chain, input);
  input.velocity_mm_s = {500.0, 0.0, -100.0};  // slides and presses: 2.2 N·s/m x 0.1 m/s
  EXPECT_NEAR((chain.step(input).static_force_N - Vec3(0.0, 0.0, 1.22)).norm(), 0.0, 1e-12);
  input.velocity_mm_s = {0.0, 0.0, -5000.0};  // inside the damper at most 0.3 m/s
  EXPECT_NEAR(chain.step(input).static_force_N.z(), 1.0 + 0.66, 1e-12);
  input.displacement_mm = {0.0, 0.0, 0.5};
  input.velocity_mm_s = {0.0, 0.0, 300.0};  // leaves quickly: 0.25 N of spring, no pull
  const SafetyOutput out = chain.step(input);
  EXPECT_NEAR(out.static_force_N.z(), 0.0, 1e-12);
  EXPECT_TRUE(out.interferences & bit(Interference::kNoPull));
}

TEST(SafetyChain, SurfaceVelocityCountsAgainstTheHands) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  (void)settled(chain, input);
  input.velocity_mm_s =
      input.surface_velocity_mm_s = {0.0, 0.0, 80.0};  // carried along: no damping
  EXPECT_NEAR(chain.step(input).static_force_N.z(), 1.0, 1e-12);
  input.surface_velocity_mm_s = {1e6, 0.0, 0.0};
  EXPECT_TRUE(chain.step(input).interferences & bit(Interference::kSurfaceSpeed));
}

TEST(SafetyChain, LocalStiffnessIsCutAtTheLimit) {
  // 8 N/mm along the normal: cut to 5.08; a factor of 4 makes K 2 just as much too stiff.
  for (const double factor : {1.0, 4.0}) {
    SafetyChain chain = armedChain(omni(0.5, 1));
    SafetyInput input = pressed(0.2, 8.0 / factor);
    input.stiffness_factor = factor;
    const SafetyOutput out = settled(chain, input);
    EXPECT_NEAR(out.static_force_N.z(), 0.2 * stiffnessLimit_N_mm(omni(0.5, 1)) / factor, 1e-12);
    EXPECT_TRUE(out.interferences & bit(Interference::kStiffness));
  }
}

TEST(SafetyChain, ForceIsClampedAsAVector) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(1.0);
  input.displacement_mm = {9.0, 0.0, 12.0};  // 7.5 N wanted
  const SafetyOutput out = settled(chain, input);
  EXPECT_NEAR((out.force_N - Vec3(1.98, 0.0, 2.64)).norm(), 0.0, 1e-9);
  EXPECT_TRUE(out.interferences & bit(Interference::kPeak));
}

TEST(SafetyChain, DynamicForceIsAddedAndFades) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  input.dynamic_N = {0.8, 0.0, 0.0};
  input.dynamic_valid = true;
  for (int i = 0; i < 150; ++i) (void)settled(chain, input);
  SafetyOutput out = chain.step(input);
  EXPECT_NEAR((out.force_N - Vec3(0.8, 0.0, 1.0)).norm(), 0.0, 1e-9);
  input.dynamic_valid = false;  // only extrapolated now: goes in 0.1 s, 8 mN a tick
  for (int i = 0; i < 100; ++i) {
    const Vec3 before = out.force_N;
    out = chain.step(input);
    EXPECT_LE((out.force_N - before).norm(), 0.0081);
  }
  EXPECT_NEAR(out.force_N.x(), 0.0, 1e-9);
  input.dynamic_N.setConstant(kNan);
  input.dynamic_valid = true;
  out = chain.step(input);
  EXPECT_TRUE(out.force_N.allFinite());
  EXPECT_TRUE(out.not_finite);
}

TEST(SafetyChain, FadesInFromZeroAtTheStart) {
  SafetyChain chain(omni(0.5, 1));
  const SafetyInput input = pressed(2.0);
  double last_N = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double now_N = chain.step(input).force_N.z();
    EXPECT_LE(now_N - last_N, 0.008) << i;
    last_N = now_N;
  }
  EXPECT_NEAR(last_N, 1.0, 1e-9);
}

TEST(SafetyChain, TooDeepAtTheStartStaysUnarmedUntilTheHandHasLeft) {
  SafetyChain chain(omni(0.5, 1));
  for (int i = 0; i < 500; ++i) {
    const SafetyOutput out = chain.step(pressed(7.0));  // above 3.3 / 0.5 mm
    EXPECT_EQ(out.force_N, Vec3(Vec3::Zero()));
    EXPECT_TRUE(out.interferences & bit(Interference::kUnarmed));
  }
  for (int i = 0; i < 500; ++i) EXPECT_EQ(chain.step(pressed(7.0 - i * 0.0139)).force_N.z(), 0.0);
  SafetyInput air;
  air.touchable = true;
  for (int i = 0; i < 250; ++i) (void)chain.step(air);
  EXPECT_NEAR(settled(chain, pressed(2.0)).force_N.z(), 1.0, 1e-9);
}

TEST(SafetyChain, StaleForceFallsInATenthOfASecondAndReturnsFromZero) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  (void)settled(chain, input);
  input.touchable = false;
  double last_N = 1.0;
  for (int i = 0; i < 100; ++i) {
    const double now_N = chain.step(input).force_N.z();
    EXPECT_LE(now_N, last_N);
    EXPECT_LE(last_N - now_N, 0.016);
    last_N = now_N;
  }
  EXPECT_NEAR(last_N, 0.0, 1e-12);
  input.touchable = true;
  EXPECT_LE(chain.step(input).force_N.z(), 0.008);
}

TEST(SafetyChain, AVanishedWorldLeavesAResidue) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  (void)settled(chain, pressed(2.0));
  SafetyInput gone;  // disconnected: no scene at all
  for (int i = 1; i <= 12; ++i) {
    EXPECT_NEAR(chain.step(gone).force_N.z(), std::max(0.0, 1.0 - 0.1 * i), 1e-9) << i;
  }
}

TEST(SafetyChain, EpochJumpRampsTheOldForceDownAndTheNewOneUp) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  (void)settled(chain, pressed(2.0));
  SafetyInput input = pressed(2.0);
  input.world_jumped = true;
  EXPECT_NEAR(chain.step(input).force_N.z(), 0.9, 1e-3);
  input.world_jumped = false;
  double least_N = 1.0;
  SafetyOutput out;
  for (int i = 0; i < 250; ++i) {
    out = chain.step(input);
    least_N = std::min(least_N, out.force_N.z());
  }
  EXPECT_LT(least_N, 0.02);
  EXPECT_NEAR(out.force_N.z(), 1.0, 1e-9);
}

TEST(SafetyChain, ALostDeviceIsRearmedOnlyFromOutside) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  (void)settled(chain, input);
  input.device_lost = true;
  EXPECT_NEAR(chain.step(input).force_N.z(), 0.9, 1e-9);
  for (int i = 0; i < 20; ++i) (void)chain.step(input);
  input.device_lost = false;
  for (int i = 0; i < 500; ++i) EXPECT_EQ(chain.step(input).force_N.z(), 0.0);
  chain.rearm();
  SafetyOutput out;
  for (int i = 0; i < 250; ++i) out = chain.step(input);
  EXPECT_NEAR(out.force_N.z(), 1.0, 1e-9);
}

TEST(SafetyChain, NonFiniteGeometryHoldsThePlaneAndFades) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  (void)settled(chain, pressed(2.0));
  for (int field = 0; field < 5; ++field) {
    SafetyInput input = pressed(2.0);
    if (field == 0) input.displacement_mm.x() = kNan;
    if (field == 1) input.normal.setConstant(kNan);
    if (field == 2) input.surface_velocity_mm_s.z() = std::numeric_limits<double>::infinity();
    if (field == 3) input.stiffness_N_mm = kNan;
    if (field == 4) input.stiffness_factor = kNan;
    const SafetyOutput out = chain.step(input);
    EXPECT_TRUE(out.not_finite) << field;
    EXPECT_NEAR(out.force_N.z(), 1.0, 0.02) << field;
    for (int i = 0; i < 250; ++i) (void)chain.step(pressed(2.0));
  }
  SafetyInput input = pressed(2.0);
  input.displacement_mm.setConstant(kNan);
  input.position_mm.z() = 0.5;  // the tip leaves the held plane by 0.5 mm
  EXPECT_NEAR(chain.step(input).static_force_N.z(), 0.75, 1e-9);
  for (int i = 0; i < 150; ++i) (void)chain.step(input);
  EXPECT_EQ(chain.step(input).force_N.z(), 0.0);
}

TEST(SafetyChain, SenselessNormalsDoNotPull) {
  for (const Vec3& normal : {Vec3(0, 0, 0), Vec3(0, 0, -1), Vec3(1, 0, 0)}) {
    SafetyChain chain = armedChain(omni(0.5, 1));
    SafetyInput input = pressed(2.0);
    input.normal = normal;
    (void)settled(chain, input);
    input.velocity_mm_s = {0.0, 0.0, 1000.0};
    EXPECT_GE(chain.step(input).static_force_N.z(), 0.0);
  }
}

TEST(SafetyChain, ADirectionThatTurnsAtOnceIsSlowed) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyOutput out = settled(chain, pressed(2.0));
  SafetyInput input = pressed(2.0);
  input.displacement_mm = {2.0, 0.0, 0.0};  // same size, elsewhere, nobody moved
  input.normal = Vec3::UnitX();
  for (int i = 0; i < 20; ++i) {
    const Vec3 before_N = out.force_N;
    out = chain.step(input);
    EXPECT_LE((out.force_N - before_N).norm(), 0.5 + 1e-9);
    EXPECT_EQ(out.step_excess_N, 0.0);
  }
  EXPECT_NEAR((out.force_N - Vec3(1.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
}

TEST(StepMeter, SeesAStepThatNothingExplains) {
  StepMeter meter{DeviceProfile{}};
  StepState state;
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  state.force_N = {0.0, 0.0, 0.2};
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  state.force_N = {0.0, 0.0, 1.2};
  EXPECT_NEAR(meter.excess_N(state, false), 0.8, 1e-12);
  state.force_N = {0.0, 0.0, 0.7};
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  // A moved tip explains K |dx| in contact, nothing in the air or across a jump of the measurement.
  state.position_mm.x() += 2.0;
  state.force_N.z() += 1.2;
  EXPECT_NEAR(meter.excess_N(state, false), 1.0, 1e-12);
  state.contact = true;
  state.local_stiffness_N_mm = 0.5;
  (void)meter.excess_N(state, false);
  state.position_mm.x() += 2.0;
  state.force_N.z() += 1.2;
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  state.position_mm.x() += 2.0;
  state.force_N.z() += 1.2;
  EXPECT_NEAR(meter.excess_N(state, true), 1.0, 1e-12);
}

// --- stability: the battery
// --------------------------------------------------------------------------------------

struct Hold {
  double low = 1e9;
  double high = -1e9;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  [[nodiscard]] double counts(double count_mm) const { return (high - low) / count_mm; }
};

/// Approach at 0.2 m/s, hold 1 N, press slowly to 2.5 N, hold, release. Worst peak-to-peak of the
/// holds in counts.
double battery(double stiffness_N_mm, int delay_ticks, const Hand& hand, double friction_N) {
  DeviceProfile profile = omni(stiffness_N_mm, delay_ticks, friction_N);
  profile.peak_N = 8.0;  // the clamp of the notes' battery
  Rig rig(profile, profile, hand);
  const bool free = hand.stiffness_N_m == 0.0;
  const double soft_mm = free ? 0.0 : 1e3 / hand.stiffness_N_m;
  const double stretch_mm = soft_mm + 1.0 / std::min(stiffness_N_mm, stiffnessLimit_N_mm(profile));
  rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
  rig.run(250);
  if (free) rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -200.0});
  const auto want = [&](double force_N, double from_mm) {
    if (free)
      rig.device.setPush({0.0, 0.0, -force_N});
    else
      rig.device.setTarget({0.0, 0.0, std::min(from_mm, 20.0) - force_N * stretch_mm});
  };
  for (int i = 0; i < 100; ++i) {  // the impact
    if (!free) want(0.0, 20.0 - 0.2 * i);
    rig.step();
  }
  Hold first;
  for (int i = 0; i < 3000; ++i) {
    want(std::min(1.0, i / 200.0), 0.0);
    rig.step();
    if (i >= 2000) first.add(rig.device.truePosition_mm().z());
  }
  for (int i = 0; i < 1500; ++i) {
    want(1.0 + i / 1000.0, 0.0);
    rig.step();
  }
  Hold second;
  for (int i = 0; i < 2000; ++i) {
    rig.step();
    if (i >= 1000) second.add(rig.device.truePosition_mm().z());
  }
  want(-0.5, 0.0);
  rig.run(500);
  EXPECT_EQ(rig.max_excess_N, 0.0);
  EXPECT_LE(rig.max_outer_excess_N, 1e-9);
  EXPECT_EQ(rig.out.force_N, Vec3(Vec3::Zero())) << "not released";
  return std::max(first.counts(0.055), second.counts(0.055));
}

TEST(SafetyChain, BatteryIsQuietUpToTheStiffestWall) {
  const struct {
    const char* name;
    Hand hand;
  } hands[] = {{"light", Hand::light()},
               {"light-grip", Hand::lightGrip()},
               {"firm", Hand::firm()},
               {"firm-grip", Hand::firmGrip()},
               {"none", Hand::none()}};
  for (int d = 0; d <= 2; ++d) {
    for (const double k : {0.5, 1.0, 2.0, 5.0, 10.0}) {
      if (k > 1.01 * stiffnessLimit_N_mm(omni(k, d)) && k > 2.0) continue;
      for (const auto& [name, hand] : hands) {
        const double rough = battery(k, d, hand, 0.0);
        const double rubbed = battery(k, d, hand, 0.05);
        std::printf("battery d %d K %4.1f %-10s residual %.2f counts, with friction %.2f\n", d, k,
                    name, rough, rubbed);
        EXPECT_LE(rough, 2.0) << name << " K " << k << " d " << d;
        EXPECT_LE(rubbed, 2.0) << name << " K " << k << " d " << d;
      }
    }
  }
}

TEST(SafetyChain, BatterySeesAWallThatIsTooStiffForItsDelay) {
  // The test above can fail: told no delay, with two ticks of it, a free device runs away at 5
  // N/mm.
  DeviceProfile told = omni(5.0, 0);
  told.peak_N = 8.0;
  DeviceProfile real = told;
  real.delay_ticks = 2;
  Rig rig(told, real, Hand::none());
  rig.run(250);
  rig.device.reset({0.0, 0.0, 5.0}, {0.0, 0.0, -200.0});
  rig.device.setPush({0.0, 0.0, -1.0});
  rig.run(3000);
  Hold hold;
  for (int i = 0; i < 500; ++i) {
    rig.step();
    hold.add(rig.device.truePosition_mm().z());
  }
  EXPECT_GT(hold.counts(0.055), 10.0);
}

// --- extreme cases
// -----------------------------------------------------------------------------------------------

/// A light hand resting 5 mm into a wall (2 mm of it the tip), K 1 or 5, friction 0.05 N.
struct Extreme {
  explicit Extreme(double stiffness_N_mm, double target_mm = -5.0)
      : rig(omni(stiffness_N_mm, 1, 0.05), omni(stiffness_N_mm, 1, 0.05), Hand::light()) {
    rig.device.reset({0.0, 0.0, 10.0}, Vec3::Zero());
    rig.run(300);
    for (int i = 0; i < 600; ++i) {
      rig.device.setTarget({0.0, 0.0, 10.0 + (target_mm - 10.0) * std::min(1.0, i / 300.0)});
      rig.step();
    }
    rig.run(1000);
    rig.clear();
  }
  ~Extreme() {
    std::printf("%-46s K %.0f: step %.2f N, peak %.2f N, excess %g N\n", name.c_str(),
                rig.stiffness_N_mm, rig.max_step_N, rig.max_force_N, rig.max_excess_N);
    EXPECT_TRUE(rig.finite) << name;
    EXPECT_EQ(rig.max_excess_N, 0.0) << name;
    EXPECT_LE(rig.max_outer_excess_N, 1e-9) << name;
    EXPECT_LE(rig.max_force_N, 3.3 + 1e-9) << name;
  }
  Extreme(const Extreme&) = delete;
  Extreme& operator=(const Extreme&) = delete;
  Rig rig;
  std::string name;
};

class SafetyExtremes : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Stiffness, SafetyExtremes, testing::Values(0.5, 1.0, 5.0));

TEST_P(SafetyExtremes, SurfaceAppearsFarAboveTheTip) {
  Extreme e(GetParam(), 5.0);
  e.name = "surface appears 30 mm above the tip";
  e.rig.wall_mm = 35.0;
  e.rig.run(1000);
  EXPECT_EQ(e.rig.max_force_N, 0.0);
  e.rig.wall_mm = 0.0;  // gone again: the hand is out, the force may return
  e.rig.run(300);
  e.rig.device.setTarget({0.0, 0.0, -5.0});
  e.rig.run(1000);
  EXPECT_GT(e.rig.out.force_N.z(), 0.5);
}

TEST_P(SafetyExtremes, SurfaceRisesThirtyMillimetresWithinAFrame) {
  Extreme e(GetParam());
  e.name = "30 mm rise within one frame of 40 ms";
  e.rig.wall_velocity_mm_s = 750.0;
  for (int i = 0; i < 40; ++i) {
    e.rig.wall_mm += 0.75;
    e.rig.step();
  }
  e.rig.wall_velocity_mm_s = 0.0;
  e.rig.run(1000);
  EXPECT_GT(e.rig.max_force_N, 1.0);
}

TEST_P(SafetyExtremes, StallThenSurfaceHigher) {
  Extreme e(GetParam());
  e.name = "stall 0.5 s, then +20 mm";
  e.rig.touchable = false;
  e.rig.run(500);
  EXPECT_EQ(e.rig.out.force_N, Vec3(Vec3::Zero()));
  e.rig.touchable = true;
  e.rig.wall_mm += 20.0;
  e.rig.clear();
  e.rig.run(1000);
  EXPECT_EQ(e.rig.max_force_N, 0.0);  // too deep: unarmed
}

TEST_P(SafetyExtremes, ImpactPulse) {
  Extreme e(GetParam());
  e.name = "pulse of 3 N, 15 ms";
  for (int i = 0; i < 15; ++i) {
    e.rig.dynamic_N = {0.0, 0.0, 3.0 * std::sin(M_PI * (i + 0.5) / 15)};
    e.rig.step();
  }
  e.rig.dynamic_N.setZero();
  e.rig.run(500);
  EXPECT_GT(e.rig.max_force_N, 2.0);
}

TEST_P(SafetyExtremes, LateTicks) {
  for (const int ms : {3, 10, 200}) {
    Extreme e(GetParam());
    e.name = "late tick of " + std::to_string(ms) + " ms";
    e.rig.step(Duration(ms * 1'000'000LL));
    e.rig.run(500);
  }
}

TEST_P(SafetyExtremes, ClockJumpMovesTheSurface) {
  for (const double by_mm : {15.0, -15.0}) {
    Extreme e(GetParam());
    e.name = "clock jump, surface " + std::to_string(static_cast<int>(by_mm)) + " mm";
    e.rig.wall_mm += by_mm;
    e.rig.step();
    e.rig.run(1000);
  }
}

TEST_P(SafetyExtremes, TipAtTwoMetresPerSecond) {
  Extreme e(GetParam(), 20.0);
  e.name = "tip at 2 m/s into the wall";
  e.rig.device.reset({0.0, 0.0, 10.0}, {0.0, 0.0, -2000.0});
  e.rig.device.setTarget({0.0, 0.0, -5.0});
  e.rig.run(1000);
  EXPECT_GT(e.rig.max_force_N, 2.0);
}

TEST_P(SafetyExtremes, NanHeightsForFiveTicks) {
  Extreme e(GetParam());
  e.name = "NaN heights for 5 ticks";
  e.rig.nan_heights = true;
  e.rig.run(5);
  e.rig.nan_heights = false;
  e.rig.run(500);
  EXPECT_GT(e.rig.out.force_N.z(), 0.5);
}

TEST_P(SafetyExtremes, NanPositionsForFiveTicks) {
  Extreme e(GetParam());
  e.name = "NaN positions for 5 ticks";
  e.rig.blind = true;
  e.rig.run(5);
  e.rig.blind = false;
  e.rig.run(500);
}

TEST_P(SafetyExtremes, ObjectArrivesFast) {
  Extreme e(GetParam(), 5.0);
  e.name = "object arrives at 0.9 m/s";
  e.rig.wall_mm = -20.0;
  e.rig.wall_velocity_mm_s = 900.0;
  for (int i = 0; i < 33; ++i) {
    e.rig.wall_mm += 0.9;
    e.rig.step();
  }
  e.rig.wall_velocity_mm_s = 0.0;
  e.rig.run(1000);
  EXPECT_GT(e.rig.max_force_N, 0.5);
}

TEST_P(SafetyExtremes, DisconnectAndDeviceLost) {
  Extreme e(GetParam());
  e.name = "disconnect, reconnect, device lost";
  e.rig.wall_present = e.rig.touchable = false;
  e.rig.run(300);
  EXPECT_EQ(e.rig.out.force_N, Vec3(Vec3::Zero()));
  e.rig.wall_present = e.rig.touchable = e.rig.epoch_jump = true;
  e.rig.run(500);
  e.rig.lost = true;
  e.rig.run(100);
  EXPECT_EQ(e.rig.out.force_N, Vec3(Vec3::Zero()));
  e.rig.lost = false;
  e.rig.chain.rearm();
  e.rig.run(500);
}

TEST_P(SafetyExtremes, GainsChangeUnderTheHand) {
  Extreme e(GetParam());
  e.name = "stiffness 0.1, 5, 0.5 in turn";
  const double own = e.rig.stiffness_N_mm;
  for (const double k : {0.1, 5.0, 0.5, own}) {
    e.rig.stiffness_N_mm = k;
    e.rig.step();
    // The allowance of the test knows the new gain only; the chain's own meter knows both.
    e.rig.max_outer_excess_N = 0.0;
    e.rig.run(200);
  }
}

// --- life
// --------------------------------------------------------------------------------------------------------

/// Minutes of everything at once; returns the last position, so that two lives can be compared bit
/// for bit.
Vec3 life(unsigned seed, const Hand& hand, int ticks) {
  const DeviceProfile profile = omni(1.0, 1, 0.05);
  Rig rig(profile, profile, hand);
  std::mt19937_64 random(seed);
  const auto chance = [&](double p) {
    return std::uniform_real_distribution(0.0, 1.0)(random) < p;
  };
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(random);
  };
  Vec3 target(0.0, 0.0, 10.0);
  Vec3 goal = target;
  double speed = 0.2;
  double from = 0.0;
  double to = 0.0;
  int stale = 0;
  int nan = 0;
  for (int i = 0; i < ticks; ++i) {
    if (i % 500 == 0) {
      goal = {between(-20, 20), between(-20, 20), between(-15, 15)};
      speed = chance(0.02) ? 2.0 : between(0.05, 0.5);
    }
    const Vec3 way = goal - target;
    if (way.norm() > 0.0) target += way * std::min(1.0, speed / way.norm());
    rig.device.setTarget(target + Vec3(0, 0, 0.3 * std::sin(0.0628 * i)));
    if (i % 40 == 0) {
      from = to;
      to = chance(0.9) ? std::clamp(to + between(-3, 3), -10.0, 10.0) : to;
    }
    const double s = (i % 40) / 40.0;
    rig.wall_mm = from + (to - from) * s * s * (3 - 2 * s);
    rig.wall_velocity_mm_s = (to - from) * 6 * s * (1 - s) / 0.04;
    if (chance(1e-4)) to = from = between(-15, 25), rig.epoch_jump = true;  // seek
    if (chance(5e-5)) to = from = between(-15, 25);                         // clock jump
    if (stale == 0 && chance(1e-4)) stale = static_cast<int>(between(200, 800));
    if (nan == 0 && chance(1e-4)) nan = static_cast<int>(between(1, 10));
    rig.touchable = stale == 0;
    rig.nan_heights = nan > 0;
    rig.blind = nan == 3;
    stale -= stale > 0;
    nan -= nan > 0;
    rig.dynamic_N = {between(-.1, .1), between(-.1, .1), chance(0.002) ? 2.0 : between(-.3, .3)};
    const bool late = chance(1e-4);
    rig.step(late ? Duration(static_cast<std::int64_t>(chance(0.3) ? 200e6 : between(1e6, 10e6)))
                  : Duration(1'000'000));
  }
  EXPECT_TRUE(rig.finite);
  EXPECT_LE(rig.max_force_N, profile.peak_N + 1e-9);
  EXPECT_EQ(rig.max_excess_N, 0.0);
  EXPECT_LE(rig.max_outer_excess_N, 1e-9);
  std::printf("life seed %u: %d s, peak %.2f N, step max %.2f N, excess %g N\n", seed, ticks / 1000,
              rig.max_force_N, rig.max_step_N, rig.max_excess_N);
  EXPECT_GT(rig.max_force_N, 1.0);
  return rig.device.truePosition_mm() + rig.out.force_N;
}

TEST(SafetyChain, LivesForMinutesWithoutAnUnexplainedStep) {
  (void)life(1, Hand::light(), 180'000);
  (void)life(2, Hand::firmGrip(), 180'000);
  (void)life(3, Hand::lightGrip(), 180'000);
}

TEST(SafetyChain, LivesTheSameLifeTwice) {
  EXPECT_EQ(life(7, Hand::lightGrip(), 20'000), life(7, Hand::lightGrip(), 20'000));
}

}  // namespace
}  // namespace hapticast::client
