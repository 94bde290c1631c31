// SPDX-License-Identifier: MIT
#include "common/cli/run_program.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <stdexcept>

#include "tests/support/log_lines.hpp"
#include "tests/support/process.hpp"

namespace hapticast {
namespace {

constexpr std::chrono::seconds kSoon{60};

TEST(RunProgram, ASignalAsksForTheEndAndASecondOneEndsNothing) {
  for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGHUP}) {
    testing::Process program([signal] {
      const std::atomic<bool>& stop = stopAtSignals();
      if (stop) return 1;
      (void)std::raise(signal);
      (void)std::raise(signal);
      return stop ? 0 : 2;
    });
    EXPECT_EQ(program.wait(kSoon), 0) << signal << ": " << program.output();
  }
}

TEST(RunProgram, BehindNohupATerminalThatClosesAsksForNothing) {
  testing::Process program([] {
    (void)std::signal(SIGHUP, SIG_IGN);
    const std::atomic<bool>& stop = stopAtSignals();
    (void)std::raise(SIGHUP);
    return stop ? 1 : 0;
  });
  EXPECT_EQ(program.wait(kSoon), 0) << program.output();
}

TEST(RunProgram, AStepThatThrowsIsOneLineOfTheLog) {
  const LogLines lines;
  EXPECT_TRUE(succeed([] {}));
  EXPECT_EQ(lines.count(), 0);
  EXPECT_FALSE(succeed([] { throw std::runtime_error("--log a.csv: \x1b is full"); }));
  EXPECT_EQ(lines.text(), "error --log a.csv: ? is full\n");
}

}  // namespace
}  // namespace hapticast
