// SPDX-License-Identifier: MIT
// Lines about a reading that lasts: the first one within 2 s, then one in a few seconds.
#include "common/recording/progress_log.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace hapticast {
namespace {

TEST(ProgressLines, ALongReadingHasALineWithinTwoSecondsAndFewAfterwards) {
  ProgressLines lines("reading a.mcap", localTime(100.0));
  std::vector<double> times_s;
  for (int i = 0; i <= 300; ++i) {  // a chunk each 0.1 s
    const auto line = lines.makeLine(i / 300.0, localTime(100.0 + 0.1 * i));
    if (line) times_s.push_back(0.1 * i);
  }
  ASSERT_FALSE(times_s.empty());
  EXPECT_LE(times_s.front(), 2.0);
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    EXPECT_GE(times_s[i] - times_s[i - 1], 2.0);
    EXPECT_LE(times_s[i] - times_s[i - 1], 10.0);
  }
  EXPECT_LE(30.0 - times_s.back(), 10.0);
}

TEST(ProgressLines, AShortReadingHasNone) {
  ProgressLines lines("reading a.mcap", localTime(100.0));
  for (const double share : {0.0, 0.5, 1.0})
    EXPECT_EQ(lines.makeLine(share, localTime(100.0 + 0.5 * share)), std::nullopt);
}

TEST(ProgressLines, ALineHasTheTextAndTheShare) {
  ProgressLines lines("reading a.mcap", localTime(100.0));
  EXPECT_EQ(lines.makeLine(0.396, localTime(102.0)), "reading a.mcap: 40 %");
}

}  // namespace
}  // namespace hapticast
