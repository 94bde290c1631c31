// SPDX-License-Identifier: MIT
#include "client/report/summary.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/temp_folder.hpp"

namespace hapticast::client {
namespace {

using Json = nlohmann::ordered_json;

/// The summary, read by a strict reader (RFC 8259); a key that stands twice fails the test.
Json written(const RunResult& result) {
  const TempFolder folder;
  const std::string file = (folder / "summary.json").string();
  writeSummary(file, result);
  std::ifstream in(file);
  std::vector<std::set<std::string>> keys;
  const auto once = [&](int /*depth*/, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key) {
      EXPECT_TRUE(keys.back().insert(parsed.get<std::string>()).second) << parsed;
    }
    return true;
  };
  Json json = Json::parse(in, once);
  return json;
}

/// A run with a number of its own in every field.
RunResult eventful() {
  RunResult result;
  result.loop.ticks = 10'000;
  result.loop.late_ticks = 3;
  for (int i = 0; i < 1000; ++i) result.loop.tick_ns.add(10'000);
  result.loop.lookup = {1, 2, 3, 4, 5};
  result.loop.contact_lookup = {0, 1500, 400, 100, 0};
  for (std::size_t i = 0; i < result.loop.safety_actions.size(); ++i) {
    result.loop.safety_actions[i] = 100 + i;
  }
  result.loop.contact_ticks = 2000;
  result.loop.safety_states = bit(SafetyState::kMovesHand) | bit(SafetyState::kForceOff);
  result.loop.max_force_N = 1.25;
  result.loop.max_force_step_N = 0.125;
  result.loop.work = {.relative_mJ = -8.0, .surface_mJ = 5.0, .object_mJ = 0.5};
  result.frames.received = 250;
  result.frames.lost = 6;
  result.frames.late = 7;
  result.frames.concealed = 8;
  result.frames.resyncs = 9;
  result.frames.reliefs_rejected = 10;
  result.frames.malformed = 11;
  result.frames.contradictions = 12;
  result.frames.slices_lost = 12;
  result.frames.slices_refused = 13;
  result.datagrams = {14, 15, 16, 17, 18, 19, 26};
  result.delivery = {Transport::kGroup, 0.25, 2};
  result.bytes_received = 12'345'678'901ULL;
  result.playout_delay_ms = 41.5;
  result.clock_offset_us = -1234567890.125;
  result.clock_error_us = 12.5;
  for (int i = 0; i < 100; ++i) result.eye_hand_ns.add(8'000'000);
  result.device = DeviceTraffic{
      .round_trips = 20, .misses = 21, .resyncs = 22, .saturated = 23, .reduced = 24, .slow = 25};
  result.realtime = {.fifo = true, .mlock = false};
  return result;
}

TEST(Summary, EveryKeyWithItsNumber) {
  Json expected = Json::parse(R"({
    "ticks": 10000, "late_ticks": 3,
    "tick_ns": {"p50": 10000, "p99": 10000, "p999": 10000, "max": 10000},
    "frames": {"received": 250, "lost": 6, "late": 7, "concealed": 8, "resyncs": 9,
               "reliefs_refused": 10, "malformed": 11, "contradictions": 12},
    "slices": {"lost": 12, "refused": 13},
    "datagrams": {"received": 14, "repeated": 15, "foreign": 16, "astray": 17, "forged": 18,
                  "over_budget": 19, "not_opened": 26},
    "delivery": {"way": "multicast", "loss": 0.25, "copies": 2},
    "bytes_received": 12345678901,
    "lookup": {"none": 1, "interpolated": 2, "extrapolated": 3, "held": 4, "faded": 5},
    "contact_lookup": {"none": 0, "interpolated": 1500, "extrapolated": 400, "held": 100, "faded": 0},
    "max_force_N": 1.25, "max_force_step_N": 0.125, "step_excess_max_N": 0.0,
    "work_mJ": {"relative": -8.0, "surface": 5.0, "object": 0.5, "user": -2.5},
    "contact_ticks": 2000,
    "playout_delay_ms": 41.5, "clock_offset_us": -1234567890.125, "clock_error_us": 12.5,
    "eye_hand_ms": {"p50": 8.0, "p95": 8.0},
    "interferences": {},
    "device": {"round_trips": 20, "misses": 21, "resyncs": 22, "saturated": 23, "reduced": 24, "slow": 25},
    "realtime": {"fifo": true, "mlock": false},
    "safety_states": ["moves_hand", "force_off"],
    "faults": []
  })");
  for (std::size_t i = 0; i < kSafetyActionNames.size(); ++i) {
    expected["interferences"][kSafetyActionNames[i]] = 100 + i;
  }
  EXPECT_EQ(written(eventful()), expected);
}

TEST(Summary, WritesNullForNonFiniteValues) {
  RunResult result;
  result.loop.step_excess_max_N = std::numeric_limits<double>::infinity();
  result.loop.work.object_mJ = std::numeric_limits<double>::quiet_NaN();
  result.clock_offset_us = -std::numeric_limits<double>::infinity();
  const Json values = written(result);
  EXPECT_TRUE(values.at("step_excess_max_N").is_null());
  EXPECT_TRUE(values.at("work_mJ").at("object").is_null());
  EXPECT_TRUE(values.at("clock_offset_us").is_null());
  EXPECT_EQ(values.at("max_force_N"), 0.0);
}

TEST(Summary, NamesTheFaults) {
  RunResult result;
  result.loop.faults[static_cast<std::size_t>(Fault::kNotFinite)] = 1;
  result.loop.faults[static_cast<std::size_t>(Fault::kLatency)] = 2;
  EXPECT_EQ(written(result).at("faults"), Json({"not_finite", "latency"}));
}

TEST(Summary, OfARunWithoutATick) {
  const Json values = written(RunResult{});
  EXPECT_EQ(values.at("ticks"), 0);
  EXPECT_EQ(values.at("tick_ns").at("max"), 0);
  EXPECT_EQ(values.at("faults"), Json::array());
  EXPECT_TRUE(values.at("eye_hand_ms").is_null());
  EXPECT_TRUE(values.at("device").is_null());
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
  EXPECT_EQ(toText(eventful()),
            "10.0 s at 1 kHz, 3 ticks late; a tick lasts 10.0 us (median), 10.0 us (99.9 %).\nIn "
            "contact for 20 % of the time, 75.0 % of it between two received frames; strongest "
            "force 1.25 N.\n250 frames received by multicast (6 lost, 7 late), playout delay 42 "
            "ms.\nThe device answered 20 times; 21 ticks began without an answer, 22 answers were "
            "damaged.\nThe safety chain acted: an invalid number was ignored (100 ticks); a "
            "surface was slowed down (101 ticks); a wall was made softer (102 ticks); the force "
            "was cut at the device's peak (104 ticks); a step was slowed (105 ticks); there was no "
            "force until the hand left the object (107 ticks); a contact that generated energy was "
            "damped (111 ticks); the energy into the hand was limited (112 ticks); the force was "
            "cut for warm motors (113 ticks); implausible motion was rejected (115 ticks).\n"
            "Note: this stream moves your hand: it did more than 100 mJ of work in 10 s.\n"
            "Note: the force is off.\n");
}

TEST(SummaryInWords, OfAChainThatHadLittleToDo) {
  RunResult result;
  result.loop.safety_actions[static_cast<std::size_t>(SafetyAction::kFade)] = 300;
  EXPECT_NE(toText(result).find("The hand's own motion explains every force step.\n"),
            std::string::npos);
  result.loop.safety_actions[static_cast<std::size_t>(SafetyAction::kTank)] = 1;
  const std::string words = toText(result);
  EXPECT_NE(words.find("acted: the energy into the hand was limited (1 tick).\n"),
            std::string::npos);
  EXPECT_EQ(words.find("explains every force step"), std::string::npos);
}

TEST(SummaryInWords, OfNothingFaultsAndSteps) {
  RunResult result;
  EXPECT_NE(toText(result).find("Nothing was touched.\n"), std::string::npos);
  EXPECT_EQ(toText(result).find("Faults"), std::string::npos);
  result.loop.step_excess_max_N = 0.5;
  result.loop.faults[static_cast<std::size_t>(Fault::kDeviceLost)] = 1;
  const std::string words = toText(result);
  EXPECT_NE(words.find("WARNING: a force step exceeded its limit by 0.500 N.\n"),
            std::string::npos);
  EXPECT_NE(words.find("Faults: [\"device_lost\"]\n"), std::string::npos);
}

}  // namespace
}  // namespace hapticast::client
