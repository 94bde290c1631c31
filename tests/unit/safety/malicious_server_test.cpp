// SPDX-License-Identifier: MIT
// Every lie through the real wire to the client's own parts, in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/support/adversarial_run.hpp"

namespace hapticast::client {
namespace {

constexpr double kSeconds = 6.0;
constexpr double kNailed_s = 2.0;
constexpr double kByDatagrams_s = 3.0;
// What the chain allows a stream to do to an Omni's force in a tick.
constexpr double kRise_N = 0.2;
constexpr double kFall_N = 0.5;
// Beyond what the counts and the true speed of the tip explain; the wall is touched ahead of the
// tip, which moves by what the last forces make of it.
constexpr double kMovingStep_N = 1.1;
constexpr double kMost_mJ = 400.0;  // README.md promises it

class LyingServerTest : public ::testing::TestWithParam<std::size_t> {};

void expectSafe(const Felt& felt) {
  EXPECT_TRUE(felt.finite);
  EXPECT_LE(felt.max_force_N, DeviceProfile{}.peak_N + 1e-9);
  EXPECT_EQ(felt.step_excess_N, 0.0);
  EXPECT_LE(felt.max_unexplained_N, kMovingStep_N);
  EXPECT_LE(felt.mostWork_mJ(10.0), kMost_mJ);
}

TEST_P(LyingServerTest, MeetsItsVerdict) {
  const testing::Lie& lie = testing::lies()[GetParam()];
  const AdversarialRun got = lieTo(lie, kSeconds);
  expectSafe(got.felt);
  EXPECT_TRUE(got.is(lie.verdict))
      << verdictName(got.verdict()) << ", not " << verdictName(lie.verdict);
  if (got.last.halt == Halt::kTrustLost) {
    EXPECT_EQ(got.felt.last_force_N, 0.0);
  }
}

TEST_P(LyingServerTest, StepsNoMoreThanTheChainAllowsUnderATipThatCannotMove) {
  const testing::Lie& lie = testing::lies()[GetParam()];
  const Felt felt = lieTo(lie, kNailed_s, Hand::light(), true).felt;
  expectSafe(felt);
  EXPECT_LE(felt.max_rise_N, kRise_N + 1e-9);
  EXPECT_LE(felt.max_fall_N, kFall_N + 1e-9);
}

TEST_P(LyingServerTest, ByDatagramsItGetsNoFurther) {
  const testing::Lie& lie = testing::lies()[GetParam()];
  const AdversarialRun got = lieTo(lie, kByDatagrams_s, Hand::light(), false, 0.05);
  expectSafe(got.felt);
  if (lie.verdict == testing::Verdict::kTrustLost) {
    EXPECT_NE(got.verdict(), testing::Verdict::kHarmless);
  }
  const Felt nailed = lieTo(lie, 0.5 * kByDatagrams_s, Hand::light(), true, 0.05).felt;
  expectSafe(nailed);
  EXPECT_LE(nailed.max_rise_N, kRise_N + 1e-9);
  EXPECT_LE(nailed.max_fall_N, kFall_N + 1e-9);
}

TEST(OtherOriginTest, TheForceFallsAndRisesAgainWithoutAStep) {
  const auto found =
      std::find_if(testing::lies().begin(), testing::lies().end(),
                   [](const testing::Lie& each) { return each.name == "clock_of_another_origin"; });
  ASSERT_NE(found, testing::lies().end());
  const Felt felt = lieTo(*found, kSeconds).felt;
  expectSafe(felt);
  EXPECT_EQ(felt.refused, 0U) << "the session goes on";
  const auto contact = [&](double from_s, double to_s) {
    return std::count(felt.contact.begin() + static_cast<std::ptrdiff_t>(from_s * 1000.0),
                      felt.contact.begin() + static_cast<std::ptrdiff_t>(to_s * 1000.0), true);
  };
  constexpr double kChange_s = 60.0 / testing::kLiarsFps;
  EXPECT_EQ(contact(kChange_s - 0.3, kChange_s), 300);
  EXPECT_EQ(contact(kChange_s + 0.03, kChange_s + 0.1), 0) << "no relief is known yet";
  EXPECT_EQ(contact(kSeconds - 0.3, kSeconds), 300);
  EXPECT_GT(felt.last_force_N, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Lies, LyingServerTest,
                         ::testing::Range<std::size_t>(0, testing::lies().size()),
                         [](const auto& at) { return testing::lies()[at.param].name; });

}  // namespace
}  // namespace hapticast::client
