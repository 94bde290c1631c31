// SPDX-License-Identifier: MIT
#include "client/haptics/safety/chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A chain that is armed and faded in, out of contact.
SafetyChain armedChain(const DeviceProfile& profile) {
  SafetyChain chain(profile);
  SafetyInput air;
  air.in_contact = true;
  for (int i = 0; i < 250; ++i) (void)chain.step(air);
  return chain;
}

SafetyInput pressed(double depth_mm, double stiffness_N_mm = 0.5) {
  SafetyInput input;
  input.in_contact = true;
  input.contact = true;
  input.displacement_mm = {0.0, 0.0, depth_mm};
  input.stiffness_N_mm = stiffness_N_mm;
  return input;
}

/// Enters the wall by the hand's motion and presses until the chain rests; returns the last output.
SafetyOutput settled(SafetyChain& chain, SafetyInput input) {
  SafetyOutput out;
  const Vec3 whole_mm = input.displacement_mm;
  const Vec3 at_mm = input.position_mm;
  for (int i = 1; i <= 60; ++i) {
    input.displacement_mm = whole_mm * std::min(1.0, i / 30.0);
    input.position_mm = input.ahead.position_mm = at_mm + whole_mm - input.displacement_mm;
    out = chain.step(input);
  }
  return out;
}

TEST(SafetyChain, ConstantsOfTheWallLaw) {
  const double expected[] = {10.0, 6.005, 3.016, 2.005, 0.764, 0.400};
  for (int d = 0; d <= 5; ++d) {
    EXPECT_NEAR(stiffnessLimit_N_mm(omni(1.0, d)), expected[d], 1e-3) << d;
  }
  EXPECT_DOUBLE_EQ(wallLead_s(1), 2.19e-3);
  EXPECT_DOUBLE_EQ(wallLead_s(-3), 1.2e-3);
  EXPECT_DOUBLE_EQ(wallLead_s(99), 8.48e-3);
  EXPECT_DOUBLE_EQ(wallDamping_Ns_m(5.0, 0.045, 5.0), std::sqrt(5000.0 * 0.045));
  EXPECT_DOUBLE_EQ(wallDamping_Ns_m(1.0, 0.045, 5.0), 0.6 * std::sqrt(1000.0 * 0.045));
}

TEST(SafetyChain, TheDamperGrowsWithDepthAndWithTheTicksInContact) {
  DamperLimit limit;
  limit.step(false);
  EXPECT_DOUBLE_EQ(limit.most_N(3.0), 0.04);
  for (int i = 1; i <= 10; ++i) {
    limit.step(true);
    EXPECT_NEAR(limit.most_N(3.0), 0.04 + 0.04 * i, 1e-12);
    EXPECT_NEAR(limit.most_N(0.02), 0.06, 1e-12);
  }
  limit.step(false);
  EXPECT_DOUBLE_EQ(limit.most_N(3.0), 0.04);
}

TEST(SafetyChain, NoFirstTouchIsABlowAtAnyMotionOfTheObject) {
  constexpr double kWay_mm = 0.33;  // a tick at 330 mm/s
  for (const double stiffness_N_mm : {0.5, 1.5, 5.0}) {
    SafetyChain chain = armedChain(omni(stiffness_N_mm, 1));
    SafetyInput input = pressed(0.0, stiffness_N_mm);
    input.contact = false;
    input.damping_Ns_m = 1e9;
    input.dynamic_N = {0.0, 0.0, 1.65};
    input.dynamic_valid = true;
    input.velocity_mm_s.z() = input.ahead.velocity_mm_s.z() = -330.0;
    Vec3 before_N = Vec3::Zero();
    for (int i = 1; i <= 20; ++i) {
      input.position_mm.z() = input.ahead.position_mm.z() = -kWay_mm * i;
      input.contact = i > 10;
      input.displacement_mm.z() = input.contact ? kWay_mm * (i - 10) : 0.0;
      const Vec3 force_N = chain.step(input).force_N;
      // The hand's way, what a force may rise by in a tick, and the damper's first word.
      EXPECT_LE((force_N - before_N).norm(), stiffness_N_mm * kWay_mm + 0.2 + 0.1)
          << stiffness_N_mm << " N/mm, tick " << i - 10;
      before_N = force_N;
    }
  }
}

TEST(SafetyChain, RestingForceIsStiffnessTimesDisplacement) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  input.displacement_mm = {0.6, 0.0, 1.6};  // spring along the displacement, not along the normal
  const SafetyOutput out = settled(chain, input);
  EXPECT_NEAR((out.force_N - Vec3(0.3, 0.0, 0.8)).norm(), 0.0, 1e-12);
  EXPECT_EQ(out.safety_actions, 0u);
}

TEST(SafetyChain, DampsAlongTheNormalOnlyAndNeverPulls) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  (void)settled(chain, input);
  input.velocity_mm_s =
      input.ahead.velocity_mm_s = {500.0, 0.0, -100.0};  // slides and presses: 2.6 N·s/m x 0.1 m/s
  EXPECT_NEAR(
      (chain.step(input).static_force_N -
       Vec3(0.0, 0.0, 1.0 + wallDamping_Ns_m(0.5, 0.045, stiffnessLimit_N_mm(0.045, 1)) * 0.1))
          .norm(),
      0.0, 1e-12);
  input.velocity_mm_s =
      input.ahead.velocity_mm_s = {0.0, 0.0, -5000.0};  // inside the damper at most 0.3 m/s
  EXPECT_NEAR(chain.step(input).static_force_N.z(),
              1.0 + wallDamping_Ns_m(0.5, 0.045, stiffnessLimit_N_mm(0.045, 1)) * 0.3, 1e-12);
  input.displacement_mm = {0.0, 0.0, 0.5};
  input.velocity_mm_s =
      input.ahead.velocity_mm_s = {0.0, 0.0, 300.0};  // leaves quickly: 0.25 N of spring, no pull
  const SafetyOutput out = chain.step(input);
  EXPECT_NEAR(out.static_force_N.z(), 0.0, 1e-12);
  EXPECT_TRUE(out.safety_actions & bit(SafetyAction::kNoPull));
}

TEST(SafetyChain, SurfaceVelocityCountsAgainstTheHands) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  (void)settled(chain, input);
  input.velocity_mm_s = input.ahead.velocity_mm_s =
      input.surface_velocity_mm_s = {0.0, 0.0, 80.0};  // carried along: no damping
  EXPECT_NEAR(chain.step(input).static_force_N.z(), 1.0, 1e-12);
  input.surface_velocity_mm_s = {1e6, 0.0, 0.0};
  EXPECT_TRUE(chain.step(input).safety_actions & bit(SafetyAction::kSurfaceSpeed));
}

TEST(SafetyChain, LocalStiffnessIsCutAtTheLimit) {
  // 8 N/mm along the normal: cut to 5.08; a factor of 4 makes K 2 just as much too stiff.
  for (const double factor : {1.0, 4.0}) {
    SafetyChain chain = armedChain(omni(0.5, 1));
    SafetyInput input = pressed(0.2, 8.0 / factor);
    input.stiffness_factor = factor;
    const SafetyOutput out = settled(chain, input);
    EXPECT_NEAR(out.static_force_N.z(), 0.2 * stiffnessLimit_N_mm(omni(0.5, 1)) / factor, 1e-12);
    EXPECT_TRUE(out.safety_actions & bit(SafetyAction::kStiffness));
  }
}

TEST(SafetyChain, ForceIsClampedAsAVector) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(1.0);
  input.displacement_mm = {9.0, 0.0, 12.0};  // 7.5 N wanted
  const SafetyOutput out = settled(chain, input);
  EXPECT_NEAR((out.force_N - Vec3(1.98, 0.0, 2.64)).norm(), 0.0, 1e-9);
  EXPECT_TRUE(out.safety_actions & bit(SafetyAction::kPeak));
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

TEST(SafetyChain, ADeepStartStaysDisarmedUntilTheHandHasLeft) {
  SafetyChain chain(omni(0.5, 1));
  for (int i = 0; i < 500; ++i) {
    const SafetyOutput out = chain.step(pressed(7.0));  // above 3.3 / 0.5 mm
    EXPECT_EQ(out.force_N, Vec3(Vec3::Zero()));
    EXPECT_TRUE(out.safety_actions & bit(SafetyAction::kDisarmed));
  }
  for (int i = 0; i < 500; ++i) EXPECT_EQ(chain.step(pressed(7.0 - i * 0.0139)).force_N.z(), 0.0);
  SafetyInput air;
  air.in_contact = true;
  for (int i = 0; i < 250; ++i) (void)chain.step(air);
  EXPECT_NEAR(settled(chain, pressed(2.0)).force_N.z(), 1.0, 1e-9);
}

TEST(SafetyChain, StaleForceFallsInATenthOfASecondAndReturnsFromZero) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  SafetyInput input = pressed(2.0);
  (void)settled(chain, input);
  input.in_contact = false;
  double last_N = 1.0;
  for (int i = 0; i < 100; ++i) {
    const double now_N = chain.step(input).force_N.z();
    EXPECT_LE(now_N, last_N);
    EXPECT_LE(last_N - now_N, 0.016);
    last_N = now_N;
  }
  EXPECT_NEAR(last_N, 0.0, 1e-12);
  input.in_contact = true;
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

TEST(SafetyChain, AJumpToTheSameSurfaceContinuesTheForce) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  (void)settled(chain, pressed(2.0));
  SafetyInput input = pressed(2.0);
  for (int i = 0; i < 250; ++i) {
    input.world_jumped = i % 10 == 0;
    EXPECT_NEAR(chain.step(input).force_N.z(), 1.0, 1e-9) << i;
  }
}

TEST(SafetyChain, AJumpToADeeperSurfaceContinuesTheForceAndThenFades) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  (void)settled(chain, pressed(2.0));
  SafetyInput input = pressed(4.0);
  input.world_jumped = true;
  double last_N = chain.step(input).force_N.z();
  EXPECT_NEAR(last_N, 1.0, 0.03);
  input.world_jumped = false;
  for (int i = 0; i < 2000; ++i) {
    const double force_N = chain.step(input).force_N.z();
    EXPECT_GE(force_N, last_N - 1e-9) << i;
    EXPECT_LE(force_N, last_N + 0.02) << i;
    last_N = force_N;
  }
  EXPECT_NEAR(last_N, 2.0, 1e-9);
}

TEST(SafetyChain, AJumpToAShallowerSurfaceReleasesTheRest) {
  SafetyChain chain = armedChain(omni(0.5, 1));
  (void)settled(chain, pressed(4.0));
  SafetyInput input = pressed(2.0);
  input.world_jumped = true;
  for (int i = 1; i <= 20; ++i) {
    EXPECT_NEAR(chain.step(input).force_N.z(), std::max(1.0, 2.0 - 0.1 * i), 1e-9) << i;
    input.world_jumped = false;
  }
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
  for (int field = 0; field < 7; ++field) {
    SafetyInput input = pressed(2.0);
    if (field == 0) input.displacement_mm.x() = kNan;
    if (field == 1) input.normal.setConstant(kNan);
    if (field == 2) input.surface_velocity_mm_s.z() = std::numeric_limits<double>::infinity();
    if (field == 3) input.stiffness_N_mm = kNan;
    if (field == 4) input.stiffness_factor = kNan;
    if (field == 5) input.ahead.position_mm.y() = kNan;
    if (field == 6) input.ahead.velocity_mm_s.z() = kNan;
    const SafetyOutput out = chain.step(input);
    EXPECT_TRUE(out.not_finite) << field;
    EXPECT_NEAR(out.force_N.z(), 1.0, 0.02) << field;
    for (int i = 0; i < 250; ++i) (void)chain.step(pressed(2.0));
  }
  SafetyInput input = pressed(2.0);
  input.displacement_mm.setConstant(kNan);
  input.position_mm.z() = input.ahead.position_mm.z() =
      0.5;  // the tip leaves the held plane by 0.5 mm
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
    input.velocity_mm_s = input.ahead.velocity_mm_s = {0.0, 0.0, 1000.0};
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

TEST(SafetyChain, ADisplacementBeyondAnyDeviceIsABrokenNumber) {
  for (const double far_mm : {2000.0, 1e200, std::numeric_limits<double>::max()}) {
    SafetyChain chain = armedChain(DeviceProfile{});
    const SafetyOutput before = settled(chain, pressed(2.0));
    SafetyInput broken = pressed(far_mm, 5.0);
    for (int i = 0; i < 300; ++i) {
      const SafetyOutput out = chain.step(broken);
      EXPECT_TRUE(out.not_finite);
      ASSERT_LE(out.force_N.norm(), before.force_N.norm() + 1e-9);
      ASSERT_EQ(out.step_excess_N, 0.0);
    }
    EXPECT_EQ(chain.acts(), false);
  }
}

}  // namespace
}  // namespace hapticast::client
