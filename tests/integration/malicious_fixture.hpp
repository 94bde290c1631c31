// SPDX-License-Identifier: MIT
// Clients as a user runs them, each at a malicious server. The client renders no force beyond the
// limits of the safety chain, and it logs the cause.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>

#include "tests/integration/programs_fixture.hpp"
#include "tests/scenes/false_streams/malicious_server.hpp"

namespace hapticast::testing {

struct ExpectedMessage {
  const char* false_stream;
  const char* said;  ///< in the client's output; empty: nothing in particular
  const char* transport = "udp";
};

class ProgramsMaliciousTest : public ProgramsTest {
 protected:
  static constexpr std::size_t kTicks = 5000;
  /// Starts a malicious server. Returns the address for its client.
  using Serve = std::function<std::string(const FalseStream&)>;
  /// Runs each false stream with a client of its own, all at once, until the client has logged what
  /// is expected, for kTicks at least.
  void runFalseStreams(std::span<const ExpectedMessage> expected, const Serve& serve) const;
  void expectFloodReported(const std::string& name, const std::string& output) const;
  static const FalseStream& named(const std::string& name) {
    const auto& all = falseStreams();
    return *std::find_if(all.begin(), all.end(), [&](const FalseStream& false_stream) {
      return false_stream.name == name;
    });
  }
  /// A hand that presses for 17 s, again and again: a client that misses many milliseconds ends the
  /// contact, and then the tip has to be lifted.
  static std::string makePresses() {
    std::string text;
    for (int i = 0; i < 10; ++i)
      text += fmt::format("{},0,0,25\n{},0,0,25\n{},0,0,4\n{},0,0,4\n", 20 * i, 20 * i + 1,
                          20 * i + 1.5, 20 * i + 18.5);
    return text;
  }
  void expectSafe(const std::string& name) const {
    const std::vector<LogRow> rows = readLog(path(name + ".csv"));
    EXPECT_GT(rows.size(), 1000U) << name;
    double most_N = 0.0;
    for (const LogRow& row : rows) most_N = std::max(most_N, row.force_N.norm());
    EXPECT_LE(most_N, 3.3 + 1e-3) << name << ", but for what the log rounds";
    EXPECT_EQ(rows.empty() ? 1.0 : rows.back().force_N.norm(), 0.0) << name << ": it ends at rest";
    const auto summary = nlohmann::json::parse(std::ifstream(path(name + ".json")));
    EXPECT_EQ(summary["step_excess_max_N"], 0.0) << name;
  }
};

inline void ProgramsMaliciousTest::runFalseStreams(std::span<const ExpectedMessage> expected,
                                                   const Serve& serve) const {
  const std::string hold = write("hold.csv", makePresses());
  std::vector<std::unique_ptr<Process>> clients;
  clients.reserve(expected.size());
  for (const ExpectedMessage& each : expected) {
    clients.push_back(
        startClient({serve(named(each.false_stream)), "--device", "virtual", "--hand", hold,
                     "--log", path(std::string(each.false_stream) + ".csv"), "--fault-dir",
                     path("faults"), "--transport", each.transport, "--interface", "lo",
                     "--summary", path(std::string(each.false_stream) + ".json")}));
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::string log = path(std::string(expected[i].false_stream) + ".csv");
    // Beside four busy processes kSoon was too short in two of three runs.
    EXPECT_TRUE(clients[i]->says(expected[i].said, kStart)) << expected[i].false_stream << ":\n"
                                                            << clients[i]->output();
    EXPECT_TRUE(waitUntil(kSoon, [&] { return readLog(log).size() > kTicks; }))
        << expected[i].false_stream;
    interrupt(*clients[i]);
    const std::string output = clients[i]->output();
    // A line for 10 s, beside those of the begin: nothing floods the log.
    const double run_s = 1e-3 * static_cast<double>(readLog(log).size());
    EXPECT_LE(std::count(output.begin(), output.end(), '\n'), 24.0 + 0.1 * run_s) << output;
    expectSafe(expected[i].false_stream);
    expectFloodReported(expected[i].false_stream, output);
  }
}

// A second with more than 400 datagrams beyond the budget is a flood. More than 400 for each second
// of the run, and for two more, need such a second, however slow the machine sends them.
inline void ProgramsMaliciousTest::expectFloodReported(const std::string& name,
                                                       const std::string& output) const {
  const std::vector<LogRow> rows = readLog(path(name + ".csv"));
  const nlohmann::json counts =
      nlohmann::json::parse(std::ifstream(path(name + ".json")))["datagrams"];
  const double run_s = rows.empty() ? 0.0 : rows.back().t_s - rows.front().t_s;
  if (counts["over_budget"].get<double>() <= 400.0 * (run_s + 2.0)) return;
  EXPECT_NE(output.find("more datagrams arrive than the client can verify"), std::string::npos)
      << output;
}

}  // namespace hapticast::testing
