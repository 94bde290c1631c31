// SPDX-License-Identifier: MIT
// Steps of the force: the part that the hand's motion explains, and the limit of the rest.
#include <gtest/gtest.h>

#include <limits>

#include "client/haptics/safety/chain.hpp"

namespace hapticast::client {
namespace {

/// Follows the steps of a force tick by tick.
class StepMeter {
 public:
  double excess_N(const StepState& now, bool measurement_jumped) {
    const MotionExplainedStep hand =
        measurement_jumped ? MotionExplainedStep{} : computeStepAllowedByMotion(now, last_);
    const double excess_N = limit_.excess_N(now.force_N, last_.force_N, hand);
    last_ = now;
    return excess_N;
  }

 private:
  StepLimit limit_{DeviceProfile{}};
  StepState last_;
};

/// A meter that has seen a tip resting in a wall of 0.5 N/mm under 1 N.
struct RestingMeter {
  RestingMeter() {
    state.contact = true;
    state.local_stiffness_N_mm = 0.5;
    state.damping_Ns_m = wallDamping_Ns_m(0.5, 0.045, stiffnessLimit_N_mm(0.045, 1));
    state.normal = Vec3::UnitZ();
    state.depth_mm = 2.0;
    for (int i = 1; i <= 10; ++i) {
      state.force_N.z() = 0.1 * i;
      EXPECT_EQ(meter.excess_N(state, false), 0.0);
    }
  }
  StepMeter meter;
  StepState state;
};

TEST(StepLimit, TheDamperExplainsOnlyItsOwnDirection) {
  const double damping_N =
      wallDamping_Ns_m(0.5, 0.045, stiffnessLimit_N_mm(0.045, 1)) * 0.1;  // of 100 mm/s
  for (const double direction : {1.0, -1.0}) {
    RestingMeter in;
    in.state.velocity_change_mm_s = {0.0, 0.0, -100.0};  // pushed in: more force, not less
    in.state.force_N.z() += direction * (damping_N + 0.6);
    const double allowed_N = direction > 0.0 ? damping_N + 0.2 : 0.5;
    EXPECT_NEAR(in.meter.excess_N(in.state, false), damping_N + 0.6 - allowed_N, 1e-9);
    RestingMeter across;
    across.state.velocity_change_mm_s = {300.0, 0.0, 0.0};  // a fast slide explains nothing
    across.state.force_N.z() += 0.6;
    EXPECT_NEAR(across.meter.excess_N(across.state, false), 0.4, 1e-9);
  }
  RestingMeter fast;  // beyond the damper's limit of 0.3 m/s to either side
  fast.state.velocity_change_mm_s = {0.0, 0.0, -5000.0};
  fast.state.force_N.z() += 4.0;
  EXPECT_NEAR(fast.meter.excess_N(fast.state, false), 4.0 - 6.0 * damping_N - 0.2, 1e-9);
}

TEST(StepLimit, AStifferStreamExplainsNothing) {
  RestingMeter meter;
  meter.state.local_stiffness_N_mm = 5.0;
  meter.state.moved_mm = 0.1;
  meter.state.velocity_change_mm_s.z() = -10.0;
  meter.state.force_N.z() += 2.0;
  const double hand_N =
      0.5 * 0.1 + wallDamping_Ns_m(0.5, 0.045, stiffnessLimit_N_mm(0.045, 1)) * 0.01;
  EXPECT_NEAR(meter.meter.excess_N(meter.state, false), 2.0 - hand_N - 0.2, 1e-9);
}

TEST(StepLimit, AMotionThatIsOnlyForeseenExplainsNothing) {
  RestingMeter meter;
  meter.state.ahead.position_mm.z() -= 0.5;
  meter.state.force_N.z() += 1.0;
  EXPECT_NEAR(meter.meter.excess_N(meter.state, false), 1.0 - 0.2, 1e-9);
}

TEST(StepLimit, AContactThatTheStreamMadeExplainsNothing) {
  for (const bool by_hand : {true, false}) {
    StepMeter meter;
    StepState state;
    state.velocity_mm_s = {0.0, 0.0, -200.0};
    EXPECT_EQ(meter.excess_N(state, false), 0.0);
    state.moved_mm = 0.2;
    state.ahead.position_mm.z() -= 0.2;
    state.contact = true;
    state.normal = Vec3::UnitZ();
    state.local_stiffness_N_mm = 0.5;
    state.damping_Ns_m = wallDamping_Ns_m(0.5, 0.045, stiffnessLimit_N_mm(0.045, 1));
    state.most_damper_N = 0.08;
    state.depth_mm = by_hand ? 0.1 : 0.3;  // the tip cannot have come deeper than it moved
    state.force_N.z() = 2.0;
    const double hand_N = 0.5 * 0.1;  // the damper alone would add 0.5 N
    EXPECT_NEAR(meter.excess_N(state, false), 2.0 - 0.2 - (by_hand ? hand_N : 0.0), 1e-9);
  }
}

TEST(CountedMotion, OneCountIsNoFastHand) {
  constexpr double kCount_mm = 0.055;
  CountedMotion motion(kCount_mm);
  for (int i = 0; i < 10; ++i) motion.add(Vec3::Zero(), false);
  for (int i = 0; i < 10; ++i) {
    motion.add({0.0, 0.0, -kCount_mm}, false);
    EXPECT_LE(motion.step_mm(), kCount_mm / 4.0 + 1e-12);
    EXPECT_NEAR(motion.change_mm_s().norm(), 0.0, 1e-9);
  }
}

TEST(CountedMotion, MeasuresAFastHandAndItsAcceleration) {
  CountedMotion motion(0.0);
  for (int i = 0; i < 20; ++i) {  // 20 m/s² from 100 mm/s
    const double t_s = i * kTick_s;
    motion.add({100.0 * t_s + 1e4 * t_s * t_s, 0.0, 0.0}, false);
  }
  EXPECT_NEAR(motion.step_mm(), 0.1 + 0.02 * 17.0, 1e-9);  // the mean of the last four ticks
  EXPECT_NEAR(motion.change_mm_s().x(), 20.0, 1e-6);
  motion.add({500.0, 0.0, 0.0}, true);
  EXPECT_EQ(motion.step_mm(), 0.0);
  EXPECT_EQ(motion.change_mm_s(), Vec3(Vec3::Zero()));
}

TEST(StepLimit, ANumberThatIsNoneIsNoSilence) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    RestingMeter meter;
    meter.state.force_N.x() = bad;
    EXPECT_EQ(meter.meter.excess_N(meter.state, false), std::numeric_limits<double>::infinity());
  }
}

TEST(StepLimit, DetectsAnUnexplainedStep) {
  StepMeter meter;
  StepState state;
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  state.force_N = {0.0, 0.0, 0.2};
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  state.force_N = {0.0, 0.0, 1.2};
  EXPECT_NEAR(meter.excess_N(state, false), 0.8, 1e-12);
  state.force_N = {0.0, 0.0, 0.7};
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  // A moved tip explains K |dx| in contact, nothing in the air or across a jump of the measurement.
  state.moved_mm = 2.0;
  state.force_N.z() += 1.2;
  EXPECT_NEAR(meter.excess_N(state, false), 1.0, 1e-12);
  state.contact = true;
  state.local_stiffness_N_mm = 0.5;
  (void)meter.excess_N(state, false);
  state.force_N.z() += 1.2;
  EXPECT_EQ(meter.excess_N(state, false), 0.0);
  state.force_N.z() += 1.2;
  EXPECT_NEAR(meter.excess_N(state, true), 1.0, 1e-12);
}

}  // namespace
}  // namespace hapticast::client
