// SPDX-License-Identifier: MIT
// Discontinuities through the whole renderer, at a hand in a plant of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/support/press_bench.hpp"

namespace hapticast::client {
namespace {

/// A hand of 150 g presses with 1.2 N. `act` prepares each tick; its arguments are the bench and
/// the number of discontinuities so far, five in a second.
std::unique_ptr<PressBench> press(void (*act)(PressBench&, int), double seconds = 8.0) {
  auto bench = std::make_unique<PressBench>(PressSetup{});
  while (bench->time_s < seconds) {
    if (bench->time_s > 2.0) act(*bench, static_cast<int>((bench->time_s - 2.0) * 5.0));
    (void)bench->step();
  }
  return bench;
}

TEST(Discontinuities, ATrackerThatGivesNewIdsChangesNoForce) {
  const auto bench = press([](PressBench& b, int n) {
    b.scene = [&b, n](PlayFrame& frame, double) {
      b.add(frame, static_cast<std::uint32_t>(1 + n));
    };
  });
  EXPECT_LT(bench->mostWork_mJ(2.0, 10.0), 0.1);
  EXPECT_NEAR(bench->renderer->report().force_N.z(), 0.86, 0.05);
  EXPECT_EQ(bench->renderer->report().trust_score_ticks, 0.0);
}

TEST(Discontinuities, ANewEpochChangesNoForceOnTheSameSurface) {
  const auto bench =
      press([](PressBench& b, int n) { b.epoch = static_cast<std::uint32_t>(1 + n / 5); });
  EXPECT_LT(bench->mostWork_mJ(2.0, 10.0), 0.3);
  EXPECT_NEAR(bench->renderer->report().force_N.z(), 0.86, 0.05);
}

TEST(Discontinuities, AnObjectThatComesAndGoesPaysFromTheAccount) {
  const auto bench = press([](PressBench& b, int n) {
    b.scene = [&b, n](PlayFrame& frame, double) {
      if (n % 2 == 0) b.add(frame, 1);
    };
  });
  // 3 mJ and 6 s of 1.5 mW, and the spring that the hand had pressed.
  EXPECT_LT(bench->mostWork_mJ(2.0, 10.0), 3.0 + 9.0 + 1.5);
}

TEST(Discontinuities, ALateMachineCostsNoTrust) {
  PressSetup setup;
  setup.stiffness_N_mm = 2.0;
  PressBench bench(setup);
  int ticks = 0;
  while (bench.time_s < 10.0) {
    (void)bench.step(bench.time_s > 2.0 && ++ticks % 200 == 0 ? 21 : 1);
  }
  EXPECT_EQ(bench.renderer->report().trust_score_ticks, 0.0);
  EXPECT_LT(bench.mostWork_mJ(2.0, 6.0), 5.0);
  EXPECT_NE(bench.renderer->report().safety_states & bit(SafetyState::kLateMachine), 0U);
}

TEST(Discontinuities, AStreamThatMovesTheHandIsLatchedUntilTheUserRearms) {
  PressSetup setup;
  setup.hand_kg = 0.5;
  setup.hand_Ns_m = 10.0;
  setup.friction_N = 0.0;
  PressBench bench(setup);
  bench.scene = [&bench](PlayFrame& frame, double t_s) {
    const bool up = static_cast<int>(12.0 * t_s) % 2 == 1;
    bench.add(frame, 1, PressBench::kPlate_mm + (up ? 5.0 : 0.0));
  };
  while (bench.time_s < 12.0) (void)bench.step();
  ASSERT_GT(bench.mostWork_mJ(0.0, 10.0), 105.0);
  bench.streaming = false;
  bench.target_mm.z() += 40.0;
  while (bench.time_s < 40.0) (void)bench.step();
  EXPECT_NE(bench.renderer->report().safety_states & bit(SafetyState::kMovesHand), 0U);
  ++bench.user.rearm_by_itself;
  EXPECT_NE(bench.step().safety_states & bit(SafetyState::kMovesHand), 0U);
  ++bench.user.rearm;
  EXPECT_EQ(bench.step().safety_states & bit(SafetyState::kMovesHand), 0U);
}

}  // namespace
}  // namespace hapticast::client
