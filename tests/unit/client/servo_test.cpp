// SPDX-License-Identifier: MIT
// The callback of OpenHaptics' thread, frame by frame under a virtual clock.
#include "client/device/touch/servo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <deque>

#include "tests/support/manual_clock.hpp"

namespace hapticast::client {
namespace {

using std::chrono::milliseconds;

/// The library, as far as the callback can see it.
struct HdWorld {
  unsigned (*callback)(void*) = nullptr;
  void* data = nullptr;
  Vec3 force_N{9.0, 9.0, 9.0};
  bool motors_on = false;
  unsigned calibration = HdFunctions::kCalibrated;
  unsigned updated = 0;
  std::deque<unsigned> errors;
};
HdWorld hd;

HdFunctions makeFunctions() {
  hd = {};
  HdFunctions functions;
  functions.makeCurrentDevice = functions.beginFrame = functions.endFrame = [](unsigned) {};
  functions.enable = [](unsigned) { hd.motors_on = true; };
  functions.disable = [](unsigned) { hd.motors_on = false; };
  functions.getError = [] {
    if (hd.errors.empty()) return HdError{};
    const unsigned code = hd.errors.front();
    hd.errors.pop_front();
    return HdError{code, 0, 0};
  };
  functions.getDoubles = [](unsigned, double* to) { std::fill_n(to, 3, 5.0); };
  functions.getIntegers = [](unsigned value, int* to) {
    *to = value == HdFunctions::kCalibrationStyle ? 5 : 2;
  };
  functions.setDoubles = [](unsigned, const double* from) {
    std::copy_n(from, 3, hd.force_N.data());
  };
  functions.checkCalibration = [] { return hd.calibration; };
  functions.updateCalibration = [](unsigned style) { hd.updated = style; };
  functions.scheduleAsynchronous = [](unsigned (*callback)(void*), void* data, unsigned short) {
    hd.callback = callback;
    hd.data = data;
    return 1UL;
  };
  functions.unschedule = [](unsigned long) { hd.callback = nullptr; };
  functions.startScheduler = functions.stopScheduler = [] {};
  return functions;
}

class ServoTest : public ::testing::Test {
 protected:
  /// Runs one frame and returns the force in it.
  static Vec3 runFrame() {
    EXPECT_EQ(hd.callback(hd.data), HdFunctions::kContinue);
    return hd.force_N;
  }
  const HdFunctions functions_ = makeFunctions();
  ManualClock clock_;
  Servo servo_{functions_, 7, clock_};
  const Vec3 force_N_{0.0, 0.5, 1.0};
};

TEST_F(ServoTest, AFrameSetsTheNewestForceAndReturnsThePosition) {
  EXPECT_TRUE(hd.motors_on);
  EXPECT_EQ(runFrame(), Vec3::Zero());
  servo_.command({3.0, 3.0, 3.0});
  servo_.command(force_N_);
  EXPECT_EQ(runFrame(), force_N_);
  const ServoReading& reading = servo_.read();
  EXPECT_EQ(reading.frames, 2U);
  EXPECT_EQ(reading.position_mm, Vec3(5.0, 5.0, 5.0));
  EXPECT_EQ(reading.buttons, 2U);
  EXPECT_EQ(reading.time, clock_.now());
}

TEST_F(ServoTest, WithoutACommandFor20MillisecondsItSetsZero) {
  servo_.command(force_N_);
  clock_.advance(milliseconds(19));
  EXPECT_EQ(runFrame(), force_N_);
  clock_.advance(milliseconds(1));
  EXPECT_EQ(runFrame(), Vec3::Zero());
  servo_.command(force_N_);
  EXPECT_EQ(runFrame(), force_N_);
}

TEST_F(ServoTest, ZeroActsUntilTheNextCommandAndWithoutFramesTheMotorsGoOff) {
  servo_.command(force_N_);
  EXPECT_FALSE(servo_.commandZero()) << "no frame runs";
  EXPECT_FALSE(hd.motors_on);
  EXPECT_EQ(runFrame(), Vec3::Zero());
  servo_.command(force_N_);
  EXPECT_EQ(runFrame(), force_N_);
}

TEST_F(ServoTest, AnUncalibratedDeviceHasNoForceAndIsUpdatedByItsInkwell) {
  hd.calibration = 0x5002;  // waits for the user's hand
  servo_.command(force_N_);
  EXPECT_EQ(runFrame(), Vec3::Zero());
  EXPECT_FALSE(servo_.read().calibrated);
  EXPECT_EQ(hd.updated, 0U);
  hd.calibration = HdFunctions::kNeedsUpdate;
  EXPECT_EQ(runFrame(), Vec3::Zero());
  EXPECT_EQ(hd.updated, 4U);
}

TEST_F(ServoTest, ErrorsOfAFrameAreSortedByTheirWeight) {
  hd.errors = {HdFunctions::kExceededForce, HdFunctions::kWarmMotors};
  (void)runFrame();
  EXPECT_FALSE(servo_.read().lost);
  EXPECT_EQ(servo_.read().limited, 1U);
  EXPECT_EQ(servo_.read().error, HdFunctions::kWarmMotors);
  for (const unsigned code : {HdFunctions::kFault, HdFunctions::kCommunication}) {
    hd.errors = {code};
    (void)runFrame();
    EXPECT_TRUE(servo_.read().lost);
  }
  EXPECT_EQ(servo_.read().faults, 2U);
  (void)runFrame();
  EXPECT_FALSE(servo_.read().lost);
  EXPECT_EQ(servo_.read().frames, 2U);
}

}  // namespace
}  // namespace hapticast::client
