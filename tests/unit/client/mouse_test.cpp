// SPDX-License-Identifier: MIT
// The mouse as a device: a tip on a spring behind a pointer that comes in steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/device/open_device.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/time.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::client {
namespace {

class MouseTest : public ::testing::Test {
 protected:
  /// Lives so long under this force, and returns where the tip is then.
  Vec3 live(int ticks, const Vec3& force_N = Vec3::Zero()) {
    DeviceState state;
    for (int i = 0; i < ticks; ++i) {
      clock.advance(kTickPeriod);
      state = device->exchange(force_N, {});
      farthest_mm = std::max(farthest_mm, state.position_mm.x());
      fastest_mm_s = std::max(fastest_mm_s, (state.position_mm - last_mm_).norm() / kTick_s);
      last_mm_ = state.position_mm;
    }
    return state.position_mm;
  }
  void pointAt(const Vec3& nominal_mm) { pointer.store({true, nominal_mm}); }

  ManualClock clock;
  LatestValue<PointerTarget> pointer;
  std::unique_ptr<HapticDevice> device = openDevice("mouse", {.clock = clock, .pointer = &pointer});
  double farthest_mm = -1e9;
  double fastest_mm_s = 0.0;

 private:
  Vec3 last_mm_{0.0, 0.0, 30.0};  // where the virtual device starts
};

TEST_F(MouseTest, RestsUntilThePointerWasOverThePicture) {
  const Vec3 begin_mm = live(1);
  EXPECT_EQ(live(500), begin_mm);
}

TEST_F(MouseTest, FollowsThePointerSmoothlyAndHardlyShootsBeyondIt) {
  (void)live(100);
  pointAt({40.0, -10.0, 10.0});
  const Vec3 at_mm = live(1500);
  EXPECT_NEAR((at_mm - Vec3(40.0, -10.0, 10.0)).norm(), 0.0, 0.6) << at_mm;
  EXPECT_LT(farthest_mm, 46.0);
  EXPECT_LT(fastest_mm_s, 600.0);
  EXPECT_GT(fastest_mm_s, 100.0);
}

TEST_F(MouseTest, AForceIsSeenAsTheWayThatTheTipStaysBehind) {
  pointAt({0.0, 0.0, 10.0});
  const Vec3 free_mm = live(1500);
  const Vec3 pushed_mm = live(1500, {0.0, 0.0, 1.0});
  // The hand's spring has 0.2 N/mm, and the device's own friction (0.05 N) holds a little.
  EXPECT_NEAR(pushed_mm.z() - free_mm.z(), 5.0, 0.6);
}

TEST_F(MouseTest, APointerThatIsNoNumberMovesNothing) {
  pointAt({5.0, 0.0, 20.0});
  const Vec3 before_mm = live(1500);
  pointAt({std::nan(""), 0.0, INFINITY});
  EXPECT_EQ(live(500), before_mm);
  pointAt({1e300, 0.0, 0.0});
  EXPECT_TRUE(live(5000).allFinite());
}

}  // namespace
}  // namespace hapticast::client
