// SPDX-License-Identifier: MIT
#include "common/time.hpp"

#include <gtest/gtest.h>

#include <type_traits>

namespace hapticast {
namespace {

static_assert(!std::is_convertible_v<MediaTime, LocalTime>);
static_assert(!std::is_constructible_v<LocalTime, MediaTime>);

TEST(Time, ConvertsSecondsBothWays) {
  EXPECT_EQ(fromSeconds(1.5), Duration(1'500'000'000));
  EXPECT_DOUBLE_EQ(toSeconds(mediaTime(2.25)), 2.25);
  EXPECT_DOUBLE_EQ(toSeconds(localTime(-0.5)), -0.5);
  EXPECT_DOUBLE_EQ(toSeconds(std::chrono::milliseconds(3)), 0.003);
}

TEST(Time, SteadyClockDoesNotRunBackwards) {
  const SteadyClock clock;
  LocalTime last = clock.now();
  for (int i = 0; i < 1000; ++i) {
    const LocalTime now = clock.now();
    EXPECT_GE(now, last);
    last = now;
  }
}

}  // namespace
}  // namespace hapticast
