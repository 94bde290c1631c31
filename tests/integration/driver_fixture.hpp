// SPDX-License-Identifier: MIT
// The real client and helper beside a driver or a maker's library that misbehaves.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "tests/integration/programs_fixture.hpp"
#include "tests/support/device/trace.hpp"

namespace hapticast::testing {

/// A fault while a force acts, and the line that the user gets; empty: none in particular.
struct ContactFault {
  const char* name;
  const char* line;
};

class ProgramsWithDriverTest : public ProgramsTest {
 protected:
  /// Starts a client for a server's address; its device does what `trace` and `fault` say.
  using Touch = std::function<std::unique_ptr<Process>(
      const std::string& address, const Trace& trace, const std::string& fault)>;
  /// Starts a client. The fault begins when a force acts: the force ends at zero, it was within the
  /// limits, and the user gets the line at most `most_lines` times.
  void misbehaveInContact(const ContactFault& fault, std::size_t most_lines,
                          const Touch& touch) const {
    const auto server = startStillServer();
    const Trace trace(path("trace"));
    const auto client = touch(addressOf(*server), trace, fault.name);
    ASSERT_TRUE(waitUntil(kSoon, [&] { return trace->force_N > 0.3; })) << client->output();
    trace->go = 1;
    EXPECT_TRUE(client->says(fault.line, kSoon)) << client->output();
    // A fault without a line is there for many exchanges.
    EXPECT_TRUE(waitUntil(kSoon, [&, from = trace->exchanges] {
      return *fault.line != '\0' || trace->exchanges > from + 100;
    })) << client->output();
    interrupt(*client);
    EXPECT_EQ(trace->force_N, 0.0) << client->output();
    EXPECT_LE(trace->most_N, 3.3 + 1e-9) << "no watchdog of its own";
    EXPECT_EQ(client->output().find('\x1b'), std::string::npos);
    if (*fault.line != '\0') {
      EXPECT_LE(countOccurrences(fault.line, client->output()), most_lines) << client->output();
    }
    interrupt(*server);
  }
};

}  // namespace hapticast::testing
