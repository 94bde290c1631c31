// SPDX-License-Identifier: MIT
// Every lie through the real wire to the client's own parts, in virtual time.
#include <gtest/gtest.h>

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

INSTANTIATE_TEST_SUITE_P(Lies, LyingServerTest,
                         ::testing::Range<std::size_t>(0, testing::lies().size()),
                         [](const auto& at) { return testing::lies()[at.param].name; });

}  // namespace
}  // namespace hapticast::client
