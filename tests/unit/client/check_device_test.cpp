// SPDX-License-Identifier: MIT
// The check of a device: a simulated free grip that follows, or does not.
#include "client/device/check_device.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <utility>

#include "client/device/virtual/virtual_device.hpp"
#include "client/haptics/tick_report.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/scripted_device.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

/// A free grip behind a driver: `motors` is what the driver makes of a force, `stuck` an axis whose
/// encoder stands. The profile is that of the scripted device, the plant is another.
class CheckedGrip {
 public:
  explicit CheckedGrip(const PlantProfile& plant, const DeviceProfile& profile,
                       const Hand& hand = Hand::none())
      : grip_(plant, hand, clock) {
    device.its_profile = profile;
    grip_.reset(Vec3::Zero(), Vec3::Zero());
    device.wait = [this](LocalTime) { clock.advance(kTickPeriod); };
    device.answer = [this](const Vec3& force_N) {
      largest_N = std::max(largest_N, force_N.norm());
      DeviceState state = grip_.exchange(motors * force_N, {});
      if (stuck >= 0) state.position_mm[stuck] = 0.11;
      return state;
    };
  }
  std::optional<DeviceCheck> check() {
    return checkDevice(device, clock, stop, [](const std::string& /*line*/) {});
  }
  ManualClock clock;
  ScriptedDevice device;
  std::atomic<bool> stop{false};
  Eigen::Matrix3d motors = Eigen::Matrix3d::Identity();
  int stuck = -1;
  double largest_N = 0.0;

 private:
  VirtualDevice grip_;
};

PlantProfile grip(double mass_kg = 0.045, int delay_ticks = 1, double count_mm = 0.055) {
  PlantProfile plant;
  plant.mass_kg = mass_kg;
  plant.delay_ticks = delay_ticks;
  plant.count_mm = count_mm;
  plant.friction_N = 0.05;
  return plant;
}

/// Returns the error that ends the check; "": none.
std::string findError(CheckedGrip& checked) {
  try {
    (void)checked.check();
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

/// Lets the device hold each force until the next one. The virtual device alone applies a force to
/// the time before it.
void holdForces(CheckedGrip& checked) {
  checked.device.answer = [last_N = Vec3(Vec3::Zero()),
                           answer = checked.device.answer](const Vec3& force_N) mutable {
    return answer(std::exchange(last_N, force_N));
  };
}

TEST(CheckDevice, AFreeGripThatFitsItsProfilePasses) {
  PlantProfile damped = grip(0.1);
  damped.damping_Ns_m = 2.0;
  for (const auto& plant :
       {grip(), grip(0.04, 0), grip(0.1, 3, 0.038), grip(0.2, 5, 0.01), damped}) {
    CheckedGrip checked(plant, plant);
    const auto check = checked.check();
    ASSERT_TRUE(check);
    EXPECT_EQ(check->fault, "");
    EXPECT_EQ(check->note, "");
    EXPECT_NEAR(check->mass_kg, plant.mass_kg, 0.15 * plant.mass_kg);
    EXPECT_NEAR(check->count_mm, plant.count_mm, 1e-6);
    EXPECT_LE(checked.largest_N, 0.3 + 1e-12);
    EXPECT_EQ(checked.device.forces_N.back(), Vec3(Vec3::Zero()));
  }
}

TEST(CheckDevice, LowersAMassAndRaisesADelay) {
  struct Case {
    PlantProfile plant;
    const char* note;
  };
  for (const Case& each :
       {Case{grip(0.045), "it moves like "}, Case{grip(0.09, 3), " ms pass from a position"}}) {
    PlantProfile profile = grip(0.09);
    CheckedGrip checked(each.plant, profile);
    const auto check = checked.check();
    ASSERT_TRUE(check);
    EXPECT_EQ(check->fault, "");
    EXPECT_NE(check->note.find(each.note), std::string::npos) << check->note;
    applyCheck(*check, profile);
    EXPECT_NEAR(profile.mass_kg, each.plant.mass_kg, 0.15 * each.plant.mass_kg);
    EXPECT_NEAR(profile.delay_ticks, each.plant.delay_ticks, 1);
    EXPECT_GE(profile.delay_ticks, 1);
  }
}

TEST(CheckDevice, RefusesWrongMotionsAndProfiles) {
  Eigen::Matrix3d swapped;
  swapped << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  Eigen::Matrix3d mirrored = Eigen::Matrix3d::Identity();
  mirrored(2, 2) = -1.0;
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& motors : {swapped, mirrored, none}) {
    CheckedGrip checked(grip(), grip());
    checked.motors = motors;
    EXPECT_NE(checked.check()->fault.find("a push of 0.3 N along "), std::string::npos) << motors;
  }
  CheckedGrip stuck(grip(), grip());
  stuck.stuck = 1;
  EXPECT_NE(stuck.check()->fault.find("along y (up)"), std::string::npos);
  CheckedGrip coarse(grip(0.045, 1, 0.11), grip());
  EXPECT_NE(coarse.check()->fault.find("count_mm = 0.055"), std::string::npos);
  CheckedGrip held(grip(), grip(), {0.3, 1.0, 20.0, 0.0, 0.0});
  const std::string held_fault = held.check()->fault;
  EXPECT_NE(held_fault.find("let go of the grip"), std::string::npos) << held_fault;
  CheckedGrip late(grip(0.045, 6), grip());
  holdForces(late);
  const std::string late_fault = late.check()->fault;
  EXPECT_NE(late_fault.find("at most 5 ms are stable"), std::string::npos) << late_fault;
}

TEST(CheckDevice, RepeatsAPushThatABusyMachineSpoils) {
  for (const int gaps : {3, 100}) {
    CheckedGrip busy(grip(), grip());
    int left = gaps;
    // The process of a driver lets a force return within 500 ms after a gap.
    LocalTime gap{};
    busy.device.wait = [&](LocalTime) {
      busy.clock.advance(kTickPeriod);
      if (busy.device.forces_N.size() % 800 != 799 || left-- <= 0) return;
      busy.clock.advance(std::chrono::milliseconds(12));
      gap = busy.clock.now();
    };
    busy.device.answer = [&, answer = busy.device.answer](const Vec3& force_N) {
      return answer(std::min(1.0, toSeconds(busy.clock.now() - gap) / 0.5) * force_N);
    };
    if (gaps == 100) {
      EXPECT_THROW((void)busy.check(), std::runtime_error);
    } else {
      EXPECT_EQ(busy.check()->fault, "");
    }
  }
}

TEST(CheckDevice, MeasuresInMillisecondsWhateverTheTicksAre) {
  using std::chrono::microseconds;
  for (const auto& [shortest, longest] :
       {std::pair{1000, 2000}, std::pair{1000, 2900}, std::pair{500, 3000}}) {
    CheckedGrip checked(grip(0.1), grip(0.1));
    holdForces(checked);
    std::mt19937 random(static_cast<unsigned>(longest));
    std::uniform_int_distribution<int> wait_us(shortest, longest);
    checked.device.wait = [&](LocalTime) { checked.clock.advance(microseconds(wait_us(random))); };
    const auto check = checked.check();
    ASSERT_TRUE(check);
    EXPECT_EQ(check->fault, "") << longest;
    EXPECT_NEAR(check->mass_kg, 0.1, 0.015) << longest;
    EXPECT_NEAR(check->delay_ticks, 1, 1) << longest;
    EXPECT_NEAR(check->count_mm, grip().count_mm, 1e-6) << longest;
  }
}

TEST(CheckDevice, NamesTheMachineThatIsTooSlow) {
  CheckedGrip no_rest(grip(), grip());
  no_rest.device.wait = [&](LocalTime) {
    const bool late = no_rest.device.forces_N.size() % 300 == 0;
    no_rest.clock.advance(std::chrono::milliseconds(late ? 12 : 1));
  };
  CheckedGrip slow(grip(), grip());
  slow.device.wait = [&](LocalTime) { slow.clock.advance(std::chrono::milliseconds(3)); };
  for (CheckedGrip* const busy : {&no_rest, &slow})
    EXPECT_EQ(findError(*busy),
              "check: this machine is too busy for the check; close other programs");
}

TEST(CheckDevice, EndsAtAStopAtALossAndAtARestlessGrip) {
  CheckedGrip stopped(grip(), grip());
  stopped.stop = true;
  EXPECT_FALSE(stopped.check());
  CheckedGrip restless(grip(), grip());
  restless.device.answer = [&restless](const Vec3&) {
    const double time_s = toSeconds(restless.clock.now().time_since_epoch());
    return DeviceState{.position_mm = 3.0 * std::sin(10.0 * time_s) * Vec3::UnitX(),
                       .buttons = 0,
                       .time = restless.clock.now()};
  };
  EXPECT_EQ(findError(restless), "check: the grip did not come to rest for a minute");
  CheckedGrip lost(grip(), grip());
  lost.device.answer = [](const Vec3&) {
    DeviceState state;
    state.status = DeviceStatus::kLost;
    return state;
  };
  EXPECT_THROW((void)lost.check(), std::runtime_error);
}

TEST(CheckDevice, TheResultIsKeptForEachSerialNumberAndProfile) {
  const TempFolder folder;
  const std::string file = (folder / "state/checked-devices").string();
  const PlantProfile profile = grip();
  EXPECT_FALSE(readCheck(file, "falcon A1", profile));
  DeviceCheck failed;
  failed.fault = "a push moved nothing";
  storeCheck(file, "falcon A1", profile, failed);
  DeviceCheck passed;
  passed.mass_kg = 0.04;
  passed.delay_ticks = 2;
  storeCheck(file, "falcon B2", profile, passed);
  EXPECT_FALSE(readCheck(file, "falcon A1", profile)) << "failed";
  EXPECT_EQ(readCheck(file, "falcon B2", profile)->mass_kg, 0.04);
  EXPECT_EQ(readCheck(file, "falcon B2", profile)->delay_ticks, 2);
  EXPECT_FALSE(readCheck(file, "falcon B2", grip(0.09))) << "another profile";
  EXPECT_TRUE(readCheck(file, "falcon B2", grip(0.045, 3))) << "a start on a busy machine";
  storeCheck(file, "falcon A1", profile, passed);
  EXPECT_TRUE(readCheck(file, "falcon A1", profile));
  storeCheck(file, "falcon A1", profile, failed);
  EXPECT_FALSE(readCheck(file, "falcon A1", profile)) << "an earlier result does not count";
}

}  // namespace
}  // namespace hapticast::client
