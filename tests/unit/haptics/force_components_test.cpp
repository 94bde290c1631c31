// SPDX-License-Identifier: MIT
// Parts of a force: press and blow.
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

ForceComponents after(TransientDetector& meter, int ticks, const TickReport& report) {
  ForceComponents parts;
  for (int i = 0; i < ticks; ++i) parts = meter.next(report);
  return parts;
}

TEST(ForceComponents, ATouchIsABlowAndThenAPress) {
  TransientDetector meter;
  EXPECT_EQ(after(meter, 100, TickReport{}).sustained_N, 0.0);
  const ForceComponents first = meter.next(pushedBy({0.0, 0.0, 1.0}));
  EXPECT_NEAR(first.sustained_N, 1.0, 1e-12);
  EXPECT_NEAR(first.transient_N, 1.0, 0.05);
  const ForceComponents held = after(meter, 500, pushedBy({0.0, 0.0, 1.0}));
  EXPECT_NEAR(held.sustained_N, 1.0, 1e-12);
  EXPECT_LT(held.transient_N, 0.001);
}

TEST(ForceComponents, ADynamicForceIsABlowThatIsHeldForAMoment) {
  TransientDetector meter;
  (void)after(meter, 500, pushedBy({0.0, 0.0, 1.0}));
  const TickReport pulse = pushedBy({0.0, 0.0, 1.0}, {0.0, 0.0, 0.8});
  EXPECT_NEAR(after(meter, 2, pulse).transient_N, 0.8, 0.05);
  const double soon_N = after(meter, 10, pushedBy({0.0, 0.0, 1.0})).transient_N;
  EXPECT_GT(soon_N, 0.5) << "an event loop has seen it";
  EXPECT_LT(after(meter, 300, pushedBy({0.0, 0.0, 1.0})).transient_N, 0.01);
}

TEST(ForceComponents, OnlyTheForceAfterTheChainCounts) {
  TransientDetector meter;
  const ForceComponents parts = meter.next(pushedBy({0.0, 0.0, 2.0}, Vec3::Zero(), 0.25));
  EXPECT_NEAR(parts.sustained_N, 0.5, 1e-12);
  const ForceComponents none = after(meter, 1, pushedBy({0.0, 0.0, 2.0}, {0.0, 1.0, 0.0}, 0.0));
  EXPECT_EQ(none.sustained_N, 0.0);
  EXPECT_EQ(none.transient_N, 0.0);
}

TEST(ForceComponents, NothingIsLeftAfterARelease) {
  TransientDetector meter;
  (void)after(meter, 5, pushedBy({0.0, 0.0, 1.0}));
  const ForceComponents parts = meter.next(TickReport{});
  EXPECT_EQ(parts.sustained_N, 0.0);
  EXPECT_EQ(parts.transient_N, 0.0);
  TickReport none = pushedBy({0.0, 0.0, 1.0});
  none.force_N.x() = std::nan("");
  EXPECT_EQ(meter.next(none).sustained_N, 0.0) << "no number is no force";
}

}  // namespace
}  // namespace hapticast::client
