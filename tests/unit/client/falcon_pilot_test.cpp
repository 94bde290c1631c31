// SPDX-License-Identifier: MIT
#include "client/device/falcon/pilot.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "client/device/falcon/kinematics.hpp"
#include "common/time.hpp"

namespace hapticast::client {
namespace {

using Phase = FalconPilot::Phase;
constexpr std::array<int, 3> kNoMotor{};

/// Replies of a device whose grip stands somewhere, a millisecond apart.
struct PilotRig {
  FalconPilot pilot{kFalconGain_test};
  LocalTime now = localTime(1.0);
  std::uint8_t homed = kAllHomed;
  Vec3 offset_mm = Vec3::Zero();
  Vec3 force_N{0.0, 0.0, 2.0};
  DeviceState state;
  FalconRequest request;

  static constexpr double kFalconGain_test = 3500.0;

  [[nodiscard]] FalconReply reply() const {
    const auto angles_rad = falconInverse_rad(kFalconCentre_m + 1e-3 * offset_mm);
    const Vec3 counts = falconEncoders(angles_rad.value());
    FalconReply reply{.homed = homed};
    for (int i = 0; i < 3; ++i)
      reply.encoders[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(counts[i]));
    return reply;
  }
  void tick(const std::optional<FalconReply>& heard) {
    now += kTickPeriod;
    request = pilot.request(force_N, now);
    if (heard) pilot.onReply(*heard, now);
    state = pilot.state();
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick(reply());
  }
  void silence(int ticks) {
    for (int i = 0; i < ticks; ++i) tick(std::nullopt);
  }
  void makeReady() {
    run(FalconPilot::kHomedReplies + 600);
    ASSERT_EQ(pilot.phase(), Phase::kReady);
  }
  [[nodiscard]] int largest() const {
    int most = 0;
    for (const int motor : request.motors) most = std::max(most, std::abs(motor));
    return most;
  }
};

TEST(FalconPilot, NoForceBeforeAllAxesAreHomed) {
  PilotRig rig;
  EXPECT_EQ(rig.pilot.phase(), Phase::kAway);
  for (const std::uint8_t homed : std::array<std::uint8_t, 5>{0, 1, 3, 6, 5}) {
    rig.homed = homed;
    for (int i = 0; i < 200; ++i) {
      rig.run(1);
      ASSERT_EQ(rig.request.motors, kNoMotor);
      ASSERT_TRUE(rig.request.homing);
      ASSERT_EQ(rig.state.status, DeviceStatus::kNoData);
    }
    EXPECT_EQ(rig.pilot.phase(), Phase::kHoming);
    EXPECT_EQ(rig.request.lights, FalconLight::kRed);
  }
}

TEST(FalconPilot, NoForceUntilTheGripIsNearTheMiddle) {
  PilotRig rig;
  rig.offset_mm = {30.0, 0.0, 35.0};
  rig.run(300);
  EXPECT_EQ(rig.pilot.phase(), Phase::kOutside);
  EXPECT_EQ(rig.request.lights, FalconLight::kBlue);
  EXPECT_EQ(rig.request.motors, kNoMotor);
  EXPECT_EQ(rig.state.status, DeviceStatus::kNoData);
  while (rig.offset_mm.z() > 20.0) {
    rig.offset_mm.z() -= 0.5;
    rig.run(1);
  }
  rig.run(2);
  EXPECT_EQ(rig.pilot.phase(), Phase::kReady);
  EXPECT_EQ(rig.request.lights, FalconLight::kGreen);
  rig.pilot.warn(true);
  int red = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    rig.run(1);
    EXPECT_NE(rig.request.lights, FalconLight::kGreen);
    red += rig.request.lights == FalconLight::kRed ? 1 : 0;
  }
  EXPECT_EQ(red, 500) << "it blinks";
  rig.pilot.warn(false);
  rig.run(1);
  EXPECT_EQ(rig.request.lights, FalconLight::kGreen);
  EXPECT_EQ(rig.state.status, DeviceStatus::kOk);
  EXPECT_NEAR((rig.state.position_mm - rig.offset_mm).norm(), 0.0, 0.05);
}

TEST(FalconPilot, TheForceIsRampedIn) {
  PilotRig rig;
  rig.run(FalconPilot::kHomedReplies + 1);
  ASSERT_EQ(rig.pilot.phase(), Phase::kReady);
  int last = 0;
  for (int i = 0; i < 600; ++i) {
    rig.run(1);
    EXPECT_GE(rig.largest(), last);
    EXPECT_LE(rig.largest() - last, 2) << "counts a tick";
    last = rig.largest();
  }
  const Vec3 torques = *falconTorques(kFalconCentre_m, rig.force_N);
  EXPECT_NEAR(last, PilotRig::kFalconGain_test * torques.cwiseAbs().maxCoeff(), 1.5);
}

TEST(FalconPilot, TheMotorsGetTheForceAtTheGrip) {
  PilotRig rig;
  rig.offset_mm = {12.0, -20.0, 15.0};
  rig.force_N = {1.5, -2.0, 3.0};
  rig.makeReady();
  Vec3 torques;
  for (int i = 0; i < 3; ++i)
    torques[i] = -rig.request.motors[static_cast<std::size_t>(i)] / PilotRig::kFalconGain_test;
  const Vec3 position_m = kFalconCentre_m + 1e-3 * rig.offset_mm;
  const Vec3 force_N = falconJacobian_rad_m(position_m)->transpose() * torques;
  EXPECT_LT((force_N - rig.force_N).norm(), 0.01 * rig.force_N.norm());
  // Beyond what the motors may get it keeps its direction.
  rig.force_N *= 100.0;
  rig.run(1);
  EXPECT_EQ(rig.largest(), FalconPilot::kMostMotor);
  for (int i = 0; i < 3; ++i)
    torques[i] = -rig.request.motors[static_cast<std::size_t>(i)] / PilotRig::kFalconGain_test;
  const Vec3 saturated_N = falconJacobian_rad_m(position_m)->transpose() * torques;
  EXPECT_LT(saturated_N.cross(rig.force_N).norm(), 0.01 * saturated_N.norm() * rig.force_N.norm());
}

TEST(FalconPilot, SendsZeroToTheMotorsAfterTwentySilentTicks) {
  PilotRig rig;
  rig.makeReady();
  rig.silence(18);
  EXPECT_GT(rig.largest(), 0);
  EXPECT_EQ(rig.state.status, DeviceStatus::kNoData);
  rig.silence(4);
  EXPECT_EQ(rig.request.motors, kNoMotor);
  rig.silence(300);
  EXPECT_EQ(rig.request.motors, kNoMotor);
  // It answers again: from zero.
  rig.run(3);
  EXPECT_EQ(rig.state.status, DeviceStatus::kOk);
  EXPECT_LE(rig.largest(), 3);
  rig.run(600);
  EXPECT_GT(rig.largest(), 100);
}

TEST(FalconPilot, ASingleWrongReplyIsLeftOut) {
  PilotRig rig;
  rig.makeReady();
  const Vec3 before_mm = rig.state.position_mm;
  FalconReply flipped = rig.reply();
  flipped.encoders[1] ^= 0x400;
  rig.tick(flipped);
  EXPECT_EQ(rig.state.status, DeviceStatus::kNoData);
  EXPECT_EQ(rig.state.position_mm, before_mm);
  EXPECT_EQ(rig.pilot.implausible(), 1U);
  rig.run(1);
  EXPECT_EQ(rig.state.status, DeviceStatus::kOk);
  EXPECT_EQ(rig.pilot.phase(), Phase::kReady);
  EXPECT_GT(rig.largest(), 100) << "the force goes on";
}

TEST(FalconPilot, CountersThatJumpAndStayThereAreHomedAnew) {
  PilotRig rig;
  rig.makeReady();
  FalconReply shifted = rig.reply();
  shifted.encoders[0] += 500;
  int without_flag = 0;
  for (int i = 0; i < 200; ++i) {
    rig.tick(shifted);
    if (!rig.request.homing) ++without_flag;
    EXPECT_NE(rig.pilot.phase(), i < 19 ? Phase::kHoming : Phase::kReady);
    if (i > FalconPilot::kMostDoubts) {
      EXPECT_EQ(rig.request.motors, kNoMotor) << i;
    }
    if (i > FalconPilot::kMostDoubts) {
      EXPECT_EQ(rig.state.status, DeviceStatus::kLost);
    }
  }
  EXPECT_EQ(without_flag, FalconPilot::kHomedReplies);
  rig.homed = 0;
  rig.run(10);
  rig.homed = kAllHomed;
  rig.run(FalconPilot::kHomedReplies + 3);
  EXPECT_EQ(rig.pilot.phase(), Phase::kReady);
}

TEST(FalconPilot, HomingThatIsLostTakesTheForceAwayUntilItIsHomedAgain) {
  PilotRig rig;
  rig.makeReady();
  rig.homed = 0x05;
  rig.run(1);
  EXPECT_EQ(rig.state.status, DeviceStatus::kLost);
  rig.run(200);
  EXPECT_EQ(rig.request.motors, kNoMotor);
  EXPECT_EQ(rig.request.lights, FalconLight::kRed);
  rig.homed = kAllHomed;
  rig.run(FalconPilot::kHomedReplies + 3);
  EXPECT_EQ(rig.state.status, DeviceStatus::kOk);
  EXPECT_LE(rig.largest(), 3) << "from zero";
}

TEST(FalconPilot, ADeviceThatWasAwayBeginsAnew) {
  PilotRig rig;
  rig.makeReady();
  rig.pilot.onLost();
  rig.silence(1);
  EXPECT_EQ(rig.state.status, DeviceStatus::kLost);
  EXPECT_EQ(rig.request.motors, kNoMotor);
  rig.homed = 0;
  rig.run(100);
  EXPECT_EQ(rig.state.status, DeviceStatus::kLost) << "there, but it does not know where it is";
  rig.homed = kAllHomed;
  rig.run(FalconPilot::kHomedReplies + 3);
  EXPECT_EQ(rig.state.status, DeviceStatus::kOk);
}

}  // namespace
}  // namespace hapticast::client
