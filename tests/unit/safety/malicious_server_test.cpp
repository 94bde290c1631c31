// SPDX-License-Identifier: MIT
// Each false stream through the real wire to the client's own parts, in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/scenes/false_streams/run_false_stream.hpp"

namespace hapticast::client {
namespace {

constexpr double kSeconds = 6.0;
constexpr double kNailed_s = 2.0;
constexpr double kByDatagrams_s = 3.0;
// Largest step of an Omni's force per tick that the chain allows to a stream.
constexpr double kRise_N = 0.2;
constexpr double kFall_N = 0.5;
// Beyond what the counts and the true speed of the tip explain; the wall is touched ahead of the
// tip, which moves by what the last forces make of it.
constexpr double kMovingStep_N = 1.1;
constexpr double kMost_mJ = 400.0;  // README.md promises it

class FalseStreamTest : public ::testing::TestWithParam<std::size_t> {};

void expectSafe(const ForceTrace& trace) {
  EXPECT_TRUE(trace.finite);
  EXPECT_LE(trace.max_force_N, DeviceProfile{}.peak_N + 1e-9);
  EXPECT_EQ(trace.step_excess_N, 0.0);
  EXPECT_LE(trace.max_unexplained_N, kMovingStep_N);
  EXPECT_LE(trace.mostWork_mJ(10.0), kMost_mJ);
}

TEST_P(FalseStreamTest, MeetsItsVerdict) {
  const testing::FalseStream& false_stream = testing::falseStreams()[GetParam()];
  const FalseStreamRun got = runFalseStream(false_stream, kSeconds);
  expectSafe(got.trace);
  EXPECT_TRUE(got.is(false_stream.verdict))
      << verdictName(got.verdict()) << ", not " << verdictName(false_stream.verdict);
  if (got.last.halt == Halt::kTrustLost) {
    EXPECT_EQ(got.trace.last_force_N, 0.0);
  }
}

TEST_P(FalseStreamTest, StepsNoMoreThanTheChainAllowsUnderATipThatCannotMove) {
  const testing::FalseStream& false_stream = testing::falseStreams()[GetParam()];
  const ForceTrace trace = runFalseStream(false_stream, kNailed_s, Hand::light(), true).trace;
  expectSafe(trace);
  EXPECT_LE(trace.max_rise_N, kRise_N + 1e-9);
  EXPECT_LE(trace.max_fall_N, kFall_N + 1e-9);
}

TEST_P(FalseStreamTest, HasTheSameVerdictByDatagrams) {
  const testing::FalseStream& false_stream = testing::falseStreams()[GetParam()];
  const FalseStreamRun got =
      runFalseStream(false_stream, kByDatagrams_s, Hand::light(), false, 0.05);
  expectSafe(got.trace);
  if (false_stream.verdict == testing::Verdict::kTrustLost) {
    EXPECT_NE(got.verdict(), testing::Verdict::kHarmless);
  }
  const ForceTrace nailed =
      runFalseStream(false_stream, 0.5 * kByDatagrams_s, Hand::light(), true, 0.05).trace;
  expectSafe(nailed);
  EXPECT_LE(nailed.max_rise_N, kRise_N + 1e-9);
  EXPECT_LE(nailed.max_fall_N, kFall_N + 1e-9);
}

TEST(MaliciousServerAfterChangeTest, TheForceFallsAndRisesAgainWithoutAStep) {
  const auto found = std::find_if(
      testing::falseStreams().begin(), testing::falseStreams().end(),
      [](const testing::FalseStream& each) { return each.name == "clock_of_another_origin"; });
  ASSERT_NE(found, testing::falseStreams().end());
  const ForceTrace trace = runFalseStream(*found, kSeconds).trace;
  expectSafe(trace);
  EXPECT_EQ(trace.refused, 0U) << "the session goes on";
  const auto contact = [&](double from_s, double to_s) {
    return std::count(trace.contact.begin() + static_cast<std::ptrdiff_t>(from_s * 1000.0),
                      trace.contact.begin() + static_cast<std::ptrdiff_t>(to_s * 1000.0), true);
  };
  constexpr double kChange_s = 60.0 / testing::kFalseStreamFps;
  EXPECT_EQ(contact(kChange_s - 0.3, kChange_s), 300);
  EXPECT_EQ(contact(kChange_s + 0.03, kChange_s + 0.1), 0) << "no relief is known yet";
  EXPECT_EQ(contact(kSeconds - 0.3, kSeconds), 300);
  EXPECT_GT(trace.last_force_N, 0.1);
}

/// Returns the rows that are the first ones of their family and verdict, or the rows that are not.
/// A family: the rows whose names begin with the same word.
std::vector<std::size_t> selectRows(bool first_ones) {
  std::set<std::pair<std::string, testing::Verdict>> known;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < testing::falseStreams().size(); ++i) {
    const testing::FalseStream& stream = testing::falseStreams()[i];
    const std::string family = stream.name.substr(0, stream.name.find('_'));
    if (known.emplace(family, stream.verdict).second == first_ones) rows.push_back(i);
  }
  return rows;
}

std::string nameRow(const ::testing::TestParamInfo<std::size_t>& row) {
  return testing::falseStreams()[row.param].name;
}

// Under the sanitizers CI runs the chosen ones alone.
INSTANTIATE_TEST_SUITE_P(Chosen, FalseStreamTest, ::testing::ValuesIn(selectRows(true)), nameRow);
INSTANTIATE_TEST_SUITE_P(Others, FalseStreamTest, ::testing::ValuesIn(selectRows(false)), nameRow);

}  // namespace
}  // namespace hapticast::client
