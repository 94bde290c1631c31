// SPDX-License-Identifier: MIT
#include "server/pipeline/plan_log.hpp"

#include <gtest/gtest.h>

#include "tests/support/log_lines.hpp"

namespace hapticast::server {
namespace {

class PlanLogTest : public ::testing::Test {
 protected:
  /// Lines that telling this has written.
  long lines(std::uint32_t id, bool on, double at_s, const std::string& how = "") {
    log_.forget();
    PlanLine line;
    line.on = on;
    line.why = (on ? "it moves" : "it is at rest") + how;
    plan_log_.log({{id, {line}}}, {{id, 1234}}, mediaTime(at_s));
    return log_.count();
  }

  LogLines log_;
  PlanLog plan_log_;
};

TEST_F(PlanLogTest, LogsAChangeOnceAndNoneThatIsRevokedAtOnce) {
  EXPECT_EQ(lines(1, true, 0.0), 1);
  EXPECT_EQ(lines(1, true, 5.0), 0) << "nothing new";
  EXPECT_EQ(lines(1, false, 5.1), 1);
  EXPECT_EQ(lines(1, true, 5.2), 0) << "too soon";
  EXPECT_EQ(lines(1, false, 5.3), 0) << "taken back";
  EXPECT_EQ(lines(1, true, 6.2), 0) << "told within the minute";
  EXPECT_EQ(lines(1, false, 63.0), 0);
  EXPECT_EQ(lines(1, true, 65.0), 1);
}

TEST_F(PlanLogTest, AnotherFigureIsNotLogged) {
  EXPECT_EQ(lines(1, true, 0.0), 1);
  EXPECT_EQ(lines(1, true, 2.0, " by 7 mm"), 1);
  EXPECT_EQ(lines(1, true, 4.0, " by 8.1 mm"), 0);
}

TEST_F(PlanLogTest, LogsNothingAgainForTheObjectsOfTheNextRound) {
  EXPECT_EQ(lines(1, true, 0.0), 1);
  EXPECT_EQ(lines(2, true, 2.0), 0) << "as the one that is gone";
  EXPECT_EQ(lines(2, false, 4.0), 1) << "new";
  EXPECT_EQ(lines(3, false, 6.0), 0);
  EXPECT_EQ(lines(3, true, 8.0), 0);
}

}  // namespace
}  // namespace hapticast::server
