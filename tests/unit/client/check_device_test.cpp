// SPDX-License-Identifier: MIT
// The check of a device: a simulated grip in a loose hand that follows, or does not.
#include "client/device/check_device.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "client/haptics/tick_report.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/scripted_device.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

/// A grip of 200 g in a loose hand; `motors` is what the driver makes of a force.
class CheckedGrip {
 public:
  explicit CheckedGrip(const Eigen::Matrix3d& motors, double drift_mm_s = 0.0) {
    device.wait = [this](LocalTime) { clock.advance(kTickPeriod); };
    device.answer = [this, motors, drift_mm_s](const Vec3& force_N) {
      largest_N = std::max(largest_N, force_N.norm());
      const Vec3 hand_N = -0.02 * position_mm - 0.001 * speed_mm_s;
      speed_mm_s += 1e-3 * 1e3 * (motors * force_N + hand_N) / 0.2;
      position_mm += 1e-3 * (speed_mm_s + Vec3::Constant(drift_mm_s));
      return DeviceState{.position_mm = position_mm, .buttons = 0, .time = clock.now()};
    };
  }
  std::optional<DeviceCheck> check() {
    return checkDevice(device, clock, stop, [](const std::string& /*line*/) {});
  }
  ManualClock clock;
  ScriptedDevice device;
  std::atomic<bool> stop{false};
  Vec3 position_mm = Vec3::Zero();
  Vec3 speed_mm_s = Vec3::Zero();
  double largest_N = 0.0;
};

TEST(CheckDevice, AGripThatFollowsPassesInADriftingHand) {
  for (const double drift_mm_s : {0.0, 0.5}) {
    CheckedGrip grip(Eigen::Matrix3d::Identity(), drift_mm_s);
    const auto check = grip.check();
    ASSERT_TRUE(check);
    EXPECT_EQ(check->fault, "");
    EXPECT_GT(check->response_mm(1, 1), 0.5);
    EXPECT_LE(grip.largest_N, 0.3 + 1e-12);
    EXPECT_EQ(grip.device.forces_N.back(), Vec3(Vec3::Zero()));
  }
}

TEST(CheckDevice, AWrongSignAWrongAxisAndAWrongSizeAreRefused) {
  Eigen::Matrix3d swapped;
  swapped << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d mirrored = Eigen::Matrix3d::Identity();
  mirrored(2, 2) = -1.0;
  for (const Eigen::Matrix3d& motors : {swapped, mirrored, Eigen::Matrix3d(Eigen::Matrix3d::Zero()),
                                        Eigen::Matrix3d(20.0 * Eigen::Matrix3d::Identity())}) {
    CheckedGrip grip(motors);
    const auto check = grip.check();
    ASSERT_TRUE(check);
    EXPECT_NE(check->fault.find("a push of 0.3 N along "), std::string::npos) << motors;
  }
  CheckedGrip grip(mirrored);
  EXPECT_NE(grip.check()->fault.find("along z (towards you)"), std::string::npos);
}

TEST(CheckDevice, EndsAtAStopAtALossAndAtARestlessHand) {
  CheckedGrip stopped(Eigen::Matrix3d::Identity());
  stopped.stop = true;
  EXPECT_FALSE(stopped.check());
  CheckedGrip restless(Eigen::Matrix3d::Identity());
  restless.device.answer = [&restless](const Vec3&) {
    const double time_s = toSeconds(restless.clock.now());
    return DeviceState{.position_mm = 3.0 * std::sin(10.0 * time_s) * Vec3::UnitX(),
                       .buttons = 0,
                       .time = restless.clock.now()};
  };
  EXPECT_THROW((void)restless.check(), std::runtime_error);
  CheckedGrip lost(Eigen::Matrix3d::Identity());
  lost.device.answer = [](const Vec3&) {
    DeviceState state;
    state.status = DeviceStatus::kLost;
    return state;
  };
  EXPECT_THROW((void)lost.check(), std::runtime_error);
}

TEST(CheckDevice, TheResultIsKeptForEachSerialNumber) {
  const TempFolder folder;
  const std::string file = (folder / "state/checked-devices").string();
  EXPECT_EQ(readCheckFault(file, "falcon A1"), "");
  storeCheck(file, "falcon A1", {.fault = "a push moved nothing"});
  storeCheck(file, "falcon B2", {});
  EXPECT_EQ(readCheckFault(file, "falcon A1"), "a push moved nothing");
  EXPECT_EQ(readCheckFault(file, "falcon B2"), "");
  storeCheck(file, "falcon A1", {});
  EXPECT_EQ(readCheckFault(file, "falcon A1"), "");
}

}  // namespace
}  // namespace hapticast::client
