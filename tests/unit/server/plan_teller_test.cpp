// SPDX-License-Identifier: MIT
#include "server/plan_teller.hpp"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <sstream>

namespace hapticast::server {
namespace {

class PlanTellerTest : public ::testing::Test {
 protected:
  PlanTellerTest() : before_(spdlog::default_logger()) {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "plan", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
  }
  ~PlanTellerTest() override { spdlog::set_default_logger(before_); }

  /// Lines that telling this has written.
  std::ptrdiff_t lines(std::uint32_t id, bool on, double at_s) {
    text_.str("");
    PlanLine line;
    line.on = on;
    line.why = on ? "it moves" : "it is at rest";
    teller_.tell({{id, {line}}}, mediaTime(at_s));
    const std::string text = text_.str();
    return std::count(text.begin(), text.end(), '\n');
  }

  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
  PlanTeller teller_;
};

TEST_F(PlanTellerTest, TellsChangesOnceAndNotWhatIsTakenBackAtOnce) {
  EXPECT_EQ(lines(1, true, 0.0), 1);
  EXPECT_EQ(lines(1, true, 5.0), 0) << "nothing new";
  EXPECT_EQ(lines(1, false, 5.1), 1);
  EXPECT_EQ(lines(1, true, 5.2), 0) << "too soon";
  EXPECT_EQ(lines(1, false, 5.3), 0) << "taken back";
  EXPECT_EQ(lines(1, true, 6.2), 1);
}

TEST_F(PlanTellerTest, ForgetsObjectsThatAreGone) {
  EXPECT_EQ(lines(1, true, 0.0), 1);
  EXPECT_EQ(lines(2, true, 0.1), 1);
  EXPECT_EQ(lines(1, true, 0.2), 1) << "the plan of a new object with an old id";
}

}  // namespace
}  // namespace hapticast::server
