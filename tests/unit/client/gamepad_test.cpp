// SPDX-License-Identifier: MIT
// A gamepad as a device, on SDL's own made-up pad and a clock that is moved by hand.
#include "client/device/gamepad.hpp"

#include <gtest/gtest.h>

#include "client/device/open_device.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/time.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/virtual_pad.hpp"

namespace hapticast::client {
namespace {

TEST(GamepadSticks, RestInTheirDeadZoneAndLeadFasterTheFartherTheyAre) {
  EXPECT_EQ(stickVelocity_mm_s({0.2, -0.1}, {0.1, 0.2}), Vec3(Vec3::Zero()));
  EXPECT_EQ(stickVelocity_mm_s({0.0, 0.0}, {1.0, 0.0}), Vec3(Vec3::Zero())) << "only forward";
  const Vec3 ends = stickVelocity_mm_s({1.0, 0.0}, {0.0, -1.0});
  EXPECT_NEAR((ends - Vec3(80.0, 0.0, -30.0)).norm(), 0.0, 1e-9) << ends.transpose();
  EXPECT_NEAR(stickVelocity_mm_s({0.0, -1.0}, {0.0, 0.0}).y(), 80.0, 1e-9) << "up is up";
  EXPECT_NEAR(stickVelocity_mm_s({1.0, 1.0}, {0.0, 0.0}).norm(), 80.0, 1e-9);
  EXPECT_NEAR(stickVelocity_mm_s({0.62, 0.0}, {0.0, 0.0}).x(), 20.0, 1e-9) << "half way";
  double last = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const double now = stickVelocity_mm_s({i * 1e-3, 0.0}, {0.0, 0.0}).x();
    EXPECT_GE(now, last);
    EXPECT_LT(now - last, 0.25) << "no step at " << i * 1e-3;
    last = now;
  }
}

TEST(GamepadMotors, TurnFasterWithTheForceAndNeverBeyondTheirEnd) {
  EXPECT_EQ(motorLevel(0.0), 0);
  EXPECT_EQ(motorLevel(-1.0), 0);
  EXPECT_EQ(motorLevel(0.5), 32768) << "half the speed is a quarter of the vibration";
  EXPECT_EQ(motorLevel(2.0), 65535);
  EXPECT_EQ(motorLevel(1e300), 65535);
}

class GamepadTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (testing::VirtualPad::others()) GTEST_SKIP() << "a real gamepad is plugged in";
    pad.plug();
    device = open();
  }
  std::unique_ptr<HapticDevice> open() { return openDevice("gamepad", {.clock = clock}); }
  /// Runs so long with this force, a turn of the main thread every 10 ms.
  DeviceState live(int ticks, double force_N = 0.0) {
    DeviceState state;
    for (int i = 0; i < ticks; ++i) {
      if (i % 10 == 0) device->poll();
      state = tick(force_N);
    }
    device->poll();
    return state;
  }
  DeviceState tick(double force_N = 0.0) {
    TickReport report;
    report.force_N = report.static_force_N = {0.0, 0.0, force_N};
    clock.advance(kTickPeriod);
    DeviceState state = device->exchange({0.0, 0.0, force_N}, report);
    fastest_mm_s = std::max(fastest_mm_s, (state.position_mm - last_mm_).norm() / kTick_s);
    last_mm_ = state.position_mm;
    return state;
  }
  std::string allNews() {
    std::string all;
    while (const auto line = device->nextMessage()) all.append(*line).append("\n");
    return all;
  }

  ManualClock clock;
  testing::VirtualPad pad;
  std::unique_ptr<HapticDevice> device;
  double fastest_mm_s = 0.0;

 private:
  Vec3 last_mm_{0.0, 0.0, 30.0};  // where the virtual device starts
};

TEST_F(GamepadTest, SticksLeadTheTip) {
  const Vec3 begin_mm = live(200).position_mm;
  EXPECT_EQ(begin_mm, tick().position_mm) << "it rests until it is led";
  pad.stick(SDL_CONTROLLER_AXIS_LEFTX, 1.0);
  pad.stick(SDL_CONTROLLER_AXIS_RIGHTY, -1.0);
  const Vec3 led_mm = live(500).position_mm;
  EXPECT_GT(led_mm.x(), 20.0);
  EXPECT_LT(led_mm.x(), 45.0);
  EXPECT_LT(led_mm.z(), begin_mm.z() - 7.0) << "forward is into the picture";
  EXPECT_LT(fastest_mm_s, 200.0);
  pad.stick(SDL_CONTROLLER_AXIS_LEFTX, 0.0);
  pad.stick(SDL_CONTROLLER_AXIS_RIGHTY, 0.0);
  const Vec3 let_go_mm = live(1000).position_mm;
  EXPECT_NEAR((let_go_mm - live(1000).position_mm).norm(), 0.0, 0.06) << "it stays";
}

TEST_F(GamepadTest, PressesAWallWithTwoNewtonsAtMost) {
  live(100);
  pad.stick(SDL_CONTROLLER_AXIS_RIGHTY, -1.0);
  double depth_mm = 0.0;  // a wall of 1 N/mm where the tip was
  const double wall_mm = tick().position_mm.z();
  double most_N = 0.0;
  for (int i = 0; i < 4000; ++i) {
    if (i % 10 == 0) device->poll();
    depth_mm = wall_mm - tick(std::max(0.0, depth_mm)).position_mm.z();
    if (i > 2000) most_N = std::max(most_N, depth_mm);
  }
  EXPECT_NEAR(most_N, 2.0, 0.3);
}

TEST_F(GamepadTest, StaysWithinItsWorkspace) {
  live(100);
  for (const auto axis : {SDL_CONTROLLER_AXIS_LEFTX, SDL_CONTROLLER_AXIS_LEFTY}) pad.stick(axis, 1);
  const Vec3 end_mm = live(6000).position_mm;
  EXPECT_NEAR(end_mm.x(), 80.0, 1.0);
  EXPECT_NEAR(end_mm.y(), -60.0, 1.0);
}

TEST_F(GamepadTest, ContactRumblesAndAReleaseStopsIt) {
  live(100);
  EXPECT_EQ(pad.motors.low, 0);
  live(20, 1.0);
  EXPECT_EQ(pad.motors.low, motorLevel(1.0));
  EXPECT_GT(pad.motors.high, motorLevel(0.5)) << "the touch itself";
  live(500, 1.0);
  EXPECT_EQ(pad.motors.low, motorLevel(1.0));
  EXPECT_LT(pad.motors.high, motorLevel(0.01)) << "a steady press";
  live(1);
  EXPECT_EQ(pad.motors.low, 0);
  EXPECT_EQ(pad.motors.high, 0);
}

TEST_F(GamepadTest, StopsTheMotorsWithoutNewForces) {
  live(100, 1.0);
  EXPECT_GT(pad.motors.low, 0);
  clock.advance(std::chrono::milliseconds(150));
  device->poll();
  EXPECT_EQ(pad.motors.low, 0);
}

TEST_F(GamepadTest, ARumbleThatIsNotRenewedEnds) {
  live(100, 1.0);
  EXPECT_GT(pad.motors.low, 0);
  for (int i = 0; i < 1000 && pad.motors.low > 0; ++i) {
    SDL_Delay(10);
    SDL_GameControllerUpdate();
  }
  EXPECT_EQ(pad.motors.low, 0);
}

TEST_F(GamepadTest, MovesNothingWithoutNewEventsOfTheStick) {
  live(100);
  pad.stick(SDL_CONTROLLER_AXIS_LEFTX, 1.0);
  live(100);
  for (int i = 0; i < 600; ++i) (void)tick();
  const Vec3 then_mm = tick().position_mm;
  for (int i = 0; i < 600; ++i) (void)tick();
  EXPECT_NEAR((tick().position_mm - then_mm).norm(), 0.0, 0.06);
}

TEST_F(GamepadTest, UnpluggedItReportsSoAndPluggedAgainItIsBack) {
  EXPECT_EQ(live(100, 1.0).status, DeviceStatus::kOk);
  EXPECT_EQ(allNews(), "");
  pad.unplug();
  EXPECT_EQ(live(100).status, DeviceStatus::kLost);
  EXPECT_EQ(allNews(), "gamepad: unplugged; plug it in again\n");
  pad.motors = {};
  pad.plug();
  EXPECT_EQ(live(100).status, DeviceStatus::kOk);
  EXPECT_EQ(allNews(), "gamepad: made-up pad is connected again; A restores the force\n");
  EXPECT_EQ(pad.motors.low, 0);
  live(20, 1.0);
  EXPECT_EQ(pad.motors.low, motorLevel(1.0));
}

TEST_F(GamepadTest, ItsButtonsPauseAndRearmAndNothingElse) {
  EXPECT_EQ(device->profile().pause_button, SDL_CONTROLLER_BUTTON_START);
  EXPECT_EQ(device->profile().rearm_button, SDL_CONTROLLER_BUTTON_A);
  pad.press(SDL_CONTROLLER_BUTTON_START);
  pad.press(SDL_CONTROLLER_BUTTON_Y);
  EXPECT_EQ(live(20).buttons, 1U << SDL_CONTROLLER_BUTTON_START);
  pad.press(SDL_CONTROLLER_BUTTON_START, false);
  pad.press(SDL_CONTROLLER_BUTTON_A);
  EXPECT_EQ(live(20).buttons, 1U << SDL_CONTROLLER_BUTTON_A);
}

TEST_F(GamepadTest, LeavesItsMotorsAtRest) {
  live(100, 1.0);
  EXPECT_GT(pad.motors.low, 0);
  device.reset();
  EXPECT_EQ(pad.motors.low, 0);
  EXPECT_EQ(pad.motors.high, 0);
}

TEST_F(GamepadTest, OneWithoutMotorsReportsSo) {
  device.reset();
  pad.unplug();
  pad.plug(/*with_motors=*/false);
  device = open();
  EXPECT_EQ(allNews(), "gamepad: this device cannot rumble and renders no force\n");
}

TEST_F(GamepadTest, IsListedAndOpenedOnlyOnRequest) {
  EXPECT_NE(listDevices({.clock = clock}).find("force; made-up pad\n"), std::string::npos)
      << listDevices({.clock = clock});
  EXPECT_EQ(device->description(),
            "gamepad (made-up pad): its sticks lead a virtual device (omni)");
  for (const DeviceKind& kind : deviceKinds())
    EXPECT_EQ(kind.by_itself, std::string(kind.name) != "gamepad");
  device.reset();
  pad.unplug();
  EXPECT_NE(listDevices({.clock = clock}).find("force; none was found"), std::string::npos)
      << listDevices({.clock = clock});
  EXPECT_THROW((void)open(), DeviceAbsent);
}

}  // namespace
}  // namespace hapticast::client
