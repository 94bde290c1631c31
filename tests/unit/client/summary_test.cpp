// SPDX-License-Identifier: MIT
#include "client/summary.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

namespace hapticast::client {
namespace {

/// Strict JSON (RFC 8259, escapes left out: the summary has none): path -> text of each scalar and
/// of each empty array. Anything else fails the test.
class StrictJson {
 public:
  explicit StrictJson(std::string text) : text_(std::move(text)) {
    value("");
    space();
    EXPECT_EQ(at_, text_.size()) << "something follows the value";
  }
  std::map<std::string, std::string> values;

 private:
  void space() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  [[nodiscard]] char now() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void expect(char wanted) {
    space();
    if (now() != wanted) fail(std::string("no ") + wanted);
    ++at_;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(what + " at " + std::to_string(at_) + " of " + text_);
  }
  std::string string() {
    expect('"');
    std::string out;
    for (; now() != '"'; ++at_) {
      if (now() < ' ' || now() == '\\') fail("a control character or an escape in a string");
      out += now();
    }
    ++at_;
    return out;
  }
  std::size_t digits() {
    const std::size_t begin = at_;
    while (std::isdigit(static_cast<unsigned char>(now())) != 0) ++at_;
    if (at_ == begin) fail("no digit");
    return at_ - begin;
  }
  void number() {
    if (now() == '-') ++at_;
    const bool zero = now() == '0';
    if (digits() > 1 && zero) fail("a leading zero");
    if (now() == '.') {
      ++at_;
      digits();
    }
    if (now() == 'e' || now() == 'E') {
      ++at_;
      if (now() == '+' || now() == '-') ++at_;
      digits();
    }
  }
  void members(const std::string& path, char open, char close) {
    expect(open);
    space();
    if (now() == close) values[path] = std::string{open, close};
    for (std::size_t i = 0; now() != close; ++i) {
      if (i > 0) expect(',');
      std::string key = std::to_string(i);
      if (open == '{') {
        key = string();
        expect(':');
      }
      value(path.empty() ? key : std::string(path).append(".").append(key));
      space();
    }
    ++at_;
  }
  void value(const std::string& path) {
    space();
    EXPECT_EQ(values.count(path), 0U) << path << " stands twice";
    if (now() == '{') return members(path, '{', '}');
    if (now() == '[') return members(path, '[', ']');
    if (now() == '"') {
      values[path] = string();
      return;
    }
    const std::size_t begin = at_;
    for (const std::string word : {"true", "false", "null"}) {
      if (text_.compare(at_, word.size(), word) == 0) at_ += word.size();
    }
    if (at_ == begin) number();
    values[path] = text_.substr(begin, at_ - begin);
  }

  std::string text_;
  std::size_t at_ = 0;
};

std::map<std::string, std::string> written(const RunResult& result) {
  const std::string file = testing::TempDir() + "hapticast_summary.json";
  writeSummary(file, result);
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::remove(file.c_str());
  return StrictJson(text).values;
}

/// A run with a number of its own in every field.
RunResult eventful() {
  RunResult result;
  result.loop.ticks = 10'000;
  result.loop.late_ticks = 3;
  for (int i = 0; i < 1000; ++i) result.loop.tick_ns.add(10'000);
  result.loop.lookup = {1, 2, 3, 4, 5};
  result.loop.contact_lookup = {0, 1500, 400, 100, 0};
  for (std::size_t i = 0; i < result.loop.interferences.size(); ++i) {
    result.loop.interferences[i] = 100 + i;
  }
  result.loop.contact_ticks = 2000;
  result.loop.max_force_N = 1.25;
  result.loop.max_force_step_N = 0.125;
  result.loop.work = {.relative_mJ = -8.0, .surface_mJ = 5.0, .object_mJ = 0.5};
  result.frames.received = 250;
  result.frames.lost = 6;
  result.frames.late = 7;
  result.frames.concealed = 8;
  result.bytes_received = 12'345'678'901ULL;
  result.playout_delay_ms = 41.5;
  result.clock_offset_us = -1234567890.125;
  result.clock_error_us = 12.5;
  result.realtime = {.fifo = true, .mlock = false};
  return result;
}

TEST(Summary, EveryKeyWithItsNumber) {
  std::map<std::string, std::string> expected = {
      {"ticks", "10000"},
      {"late_ticks", "3"},
      {"frames.received", "250"},
      {"frames.lost", "6"},
      {"frames.late", "7"},
      {"frames.concealed", "8"},
      {"bytes_received", "12345678901"},
      {"lookup.none", "1"},
      {"lookup.interpolated", "2"},
      {"lookup.extrapolated", "3"},
      {"lookup.held", "4"},
      {"lookup.faded", "5"},
      {"contact_lookup.none", "0"},
      {"contact_lookup.interpolated", "1500"},
      {"contact_lookup.extrapolated", "400"},
      {"contact_lookup.held", "100"},
      {"contact_lookup.faded", "0"},
      {"max_force_N", "1.25"},
      {"max_force_step_N", "0.125"},
      {"step_excess_max_N", "0"},
      {"work_mJ.relative", "-8"},
      {"work_mJ.surface", "5"},
      {"work_mJ.object", "0.5"},
      {"work_mJ.user", "-2.5"},
      {"contact_ticks", "2000"},
      {"playout_delay_ms", "41.500"},
      {"clock_offset_us", "-1234567890.125"},
      {"clock_error_us", "12.500"},
      {"realtime.fifo", "true"},
      {"realtime.mlock", "false"},
      {"faults", "[]"},
  };
  for (const char* key : {"p50", "p99", "p999", "max"}) {
    expected[std::string("tick_ns.") + key] = "10000";
  }
  for (std::size_t i = 0; i < kInterferenceNames.size(); ++i) {
    expected[std::string("interferences.") + kInterferenceNames[i]] = std::to_string(100 + i);
  }
  EXPECT_EQ(written(eventful()), expected);
}

TEST(Summary, NamesTheFaults) {
  RunResult result;
  result.loop.faults[static_cast<std::size_t>(Fault::kNotFinite)] = 1;
  result.loop.faults[static_cast<std::size_t>(Fault::kLatency)] = 2;
  const auto values = written(result);
  EXPECT_EQ(values.at("faults.0"), "not_finite");
  EXPECT_EQ(values.at("faults.1"), "latency");
  EXPECT_EQ(values.count("faults.2"), 0U);
}

TEST(Summary, OfARunWithoutATick) {
  const auto values = written(RunResult{});
  EXPECT_EQ(values.at("ticks"), "0");
  EXPECT_EQ(values.at("tick_ns.max"), "0");
  EXPECT_EQ(values.at("faults"), "[]");
}

TEST(Summary, AFileThatCannotBeWrittenIsNamed) {
  for (const std::string file : {"/nonexistent/summary.json", "/dev/full"}) {
    try {
      writeSummary(file, RunResult{});
      ADD_FAILURE() << file << " was written";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("--summary " + file), std::string::npos);
    }
  }
}

TEST(SummaryInWords, OfARun) {
  EXPECT_EQ(inWords(eventful()),
            "10.0 s at 1 kHz, 3 ticks late; a tick takes 10.0 us (median), 10.0 us (99.9 %).\n"
            "In contact for 20 % of the time, 75.0 % of it between two received frames; strongest "
            "force 1.25 N.\n"
            "250 frames received (6 lost, 7 late), played 42 ms behind their arrival's clock.\n"
            "No force step that the hand's own motion does not explain.\n");
}

TEST(SummaryInWords, OfNothingFaultsAndSteps) {
  RunResult result;
  EXPECT_NE(inWords(result).find("Nothing was touched.\n"), std::string::npos);
  EXPECT_EQ(inWords(result).find("Faults"), std::string::npos);
  result.loop.step_excess_max_N = 0.5;
  result.loop.faults[static_cast<std::size_t>(Fault::kDeviceLost)] = 1;
  const std::string words = inWords(result);
  EXPECT_NE(words.find("WARNING: a force step exceeded its limit by 0.500 N.\n"),
            std::string::npos);
  EXPECT_NE(words.find("Faults: [\"device_lost\"]\n"), std::string::npos);
}

}  // namespace
}  // namespace hapticast::client
