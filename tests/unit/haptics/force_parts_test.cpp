// SPDX-License-Identifier: MIT
// What of a force is a press, what a blow.
#include "client/haptics/force_components.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hapticast::client {
namespace {

TickReport pushedBy(const Vec3& static_N, const Vec3& dynamic_N = Vec3::Zero(),
                    double share = 1.0) {
  TickReport report;
  report.static_force_N = static_N;
  report.dynamic_force_N = dynamic_N;
  report.force_N = share * (static_N + dynamic_N);
  return report;
}

ForceParts after(ForceMeter& meter, int ticks, const TickReport& report) {
  ForceParts parts;
  for (int i = 0; i < ticks; ++i) parts = meter.next(report);
  return parts;
}

TEST(ForceParts, ATouchIsABlowAndThenAPress) {
  ForceMeter meter;
  EXPECT_EQ(after(meter, 100, TickReport{}).press_N, 0.0);
  const ForceParts first = meter.next(pushedBy({0.0, 0.0, 1.0}));
  EXPECT_NEAR(first.press_N, 1.0, 1e-12);
  EXPECT_NEAR(first.blow_N, 1.0, 0.05);
  const ForceParts held = after(meter, 500, pushedBy({0.0, 0.0, 1.0}));
  EXPECT_NEAR(held.press_N, 1.0, 1e-12);
  EXPECT_LT(held.blow_N, 0.001);
}

TEST(ForceParts, ADynamicForceIsABlowThatIsHeldForAMoment) {
  ForceMeter meter;
  (void)after(meter, 500, pushedBy({0.0, 0.0, 1.0}));
  const TickReport pulse = pushedBy({0.0, 0.0, 1.0}, {0.0, 0.0, 0.8});
  EXPECT_NEAR(after(meter, 2, pulse).blow_N, 0.8, 0.05);
  const double soon_N = after(meter, 10, pushedBy({0.0, 0.0, 1.0})).blow_N;
  EXPECT_GT(soon_N, 0.5) << "an event loop has seen it";
  EXPECT_LT(after(meter, 300, pushedBy({0.0, 0.0, 1.0})).blow_N, 0.01);
}

TEST(ForceParts, OnlyWhatTheChainLetThroughIsFelt) {
  ForceMeter meter;
  const ForceParts parts = meter.next(pushedBy({0.0, 0.0, 2.0}, Vec3::Zero(), 0.25));
  EXPECT_NEAR(parts.press_N, 0.5, 1e-12);
  const ForceParts none = after(meter, 1, pushedBy({0.0, 0.0, 2.0}, {0.0, 1.0, 0.0}, 0.0));
  EXPECT_EQ(none.press_N, 0.0);
  EXPECT_EQ(none.blow_N, 0.0);
}

TEST(ForceParts, NothingIsLeftAfterARelease) {
  ForceMeter meter;
  (void)after(meter, 5, pushedBy({0.0, 0.0, 1.0}));
  const ForceParts parts = meter.next(TickReport{});
  EXPECT_EQ(parts.press_N, 0.0);
  EXPECT_EQ(parts.blow_N, 0.0);
  TickReport none = pushedBy({0.0, 0.0, 1.0});
  none.force_N.x() = std::nan("");
  EXPECT_EQ(meter.next(none).press_N, 0.0) << "no number is no force";
}

}  // namespace
}  // namespace hapticast::client
