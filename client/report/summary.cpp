// SPDX-License-Identifier: MIT
#include "client/report/summary.hpp"

#include <fmt/core.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "client/haptics/safety/safety_action.hpp"
#include "client/haptics/safety/safety_state.hpp"
#include "client/report/tick_log.hpp"

namespace hapticast::client {

namespace {

// ordered_json: the keys of the file have the order of this code.
using Json = nlohmann::ordered_json;

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Returns {"name": count, ...} for an array of counters.
template <std::size_t N, class Name>
Json counters(const std::array<std::uint64_t, N>& counts, Name name) {
  Json object;
  for (std::size_t i = 0; i < N; ++i) object[name(i)] = counts[i];
  return object;
}

/// Returns the safety actions with their ticks as text. Empty without actions that a hand notices
/// (fades and the wall law's own limits are normal).
std::string chainInWords(const LoopStats& loop) {
  std::string text;
  for (std::size_t i = 0; i < loop.safety_actions.size(); ++i) {
    const std::string what = toText(static_cast<SafetyAction>(i));
    const std::uint64_t ticks = loop.safety_actions[i];
    if (what.empty() || ticks == 0) continue;
    text += fmt::format("{}{} ({} {})", text.empty() ? "" : "; ", what, ticks,
                        ticks == 1 ? "tick" : "ticks");
  }
  return text.empty() ? text : "The safety chain acted: " + text + ".\n";
}

/// Returns the names of the faults of the run.
Json faultNames(const std::array<std::uint64_t, kFaultKinds>& faults) {
  Json names = Json::array();
  for (std::size_t i = 1; i < faults.size(); ++i) {
    if (faults[i] > 0) names.push_back(faultName(static_cast<Fault>(i)));
  }
  return names;
}

/// Returns the names of the safety states that the run had.
Json stateNames(std::uint32_t states) {
  Json names = Json::array();
  for (std::size_t i = 0; i < kSafetyStates; ++i) {
    if ((states >> i & 1U) != 0) names.push_back(kSafetyStateNames[i]);
  }
  return names;
}

/// Returns a line for each safety state that the run had.
std::string statesInWords(std::uint32_t states) {
  std::string text;
  for (std::size_t i = 0; i < kSafetyStates; ++i) {
    if ((states >> i & 1U) != 0)
      text += fmt::format("Note: {}.\n", toText(static_cast<SafetyState>(i)));
  }
  return text;
}

Json toJson(const ReceiverCounts& frames) {
  return {{"received", frames.received},   {"lost", frames.lost},
          {"late", frames.late},           {"concealed", frames.concealed},
          {"resyncs", frames.resyncs},     {"reliefs_refused", frames.reliefs_rejected},
          {"malformed", frames.malformed}, {"contradictions", frames.contradictions}};
}

Json toJson(const DatagramCounts& datagrams) {
  return {{"received", datagrams.received},    {"repeated", datagrams.repeated},
          {"foreign", datagrams.foreign},      {"astray", datagrams.astray},
          {"forged", datagrams.forged},        {"over_budget", datagrams.over_budget},
          {"not_opened", datagrams.not_opened}};
}

/// Returns null without a window.
Json toJson(const Histogram& offset_ns) {
  if (offset_ns.count() == 0) return nullptr;
  const auto milliseconds = [&](double quantile) {
    return static_cast<double>(offset_ns.quantile_ns(quantile)) * 1e-6;
  };
  return {{"p50", milliseconds(0.5)}, {"p95", milliseconds(0.95)}};
}

/// Returns null for a device without a protocol.
Json toJson(const std::optional<DeviceTraffic>& device) {
  if (!device) return nullptr;
  return {{"round_trips", device->round_trips}, {"misses", device->misses},
          {"resyncs", device->resyncs},         {"saturated", device->saturated},
          {"reduced", device->reduced},         {"slow", device->slow}};
}

Json toJson(const PortWork& work) {
  return {{"relative", work.relative_mJ},
          {"surface", work.surface_mJ},
          {"object", work.object_mJ},
          {"user", work.user_mJ()}};
}

Json summary(const RunResult& result) {
  const LoopStats& loop = result.loop;
  const auto lookupKey = [](std::size_t i) { return lookupName(static_cast<Lookup>(i)); };
  return {
      {"ticks", loop.ticks},
      {"late_ticks", loop.late_ticks},
      {"tick_ns",
       {{"p50", loop.tick_ns.quantile_ns(0.5)},
        {"p99", loop.tick_ns.quantile_ns(0.99)},
        {"p999", loop.tick_ns.quantile_ns(0.999)},
        {"max", loop.tick_ns.max_ns()}}},
      {"frames", toJson(result.frames)},
      {"slices", {{"lost", result.frames.slices_lost}, {"refused", result.frames.slices_refused}}},
      {"datagrams", toJson(result.datagrams)},
      {"delivery",
       {{"way", transportName(result.delivery.transport)},
        {"loss", result.delivery.loss},
        {"copies", result.delivery.copies}}},
      {"bytes_received", result.bytes_received},
      {"lookup", counters(loop.lookup, lookupKey)},
      {"contact_lookup", counters(loop.contact_lookup, lookupKey)},
      {"max_force_N", loop.max_force_N},
      {"max_force_step_N", loop.max_force_step_N},
      {"step_excess_max_N", loop.step_excess_max_N},
      {"work_mJ", toJson(loop.work)},
      {"contact_ticks", loop.contact_ticks},
      {"playout_delay_ms", result.playout_delay_ms},
      {"clock_offset_us", result.clock_offset_us},
      {"clock_error_us", result.clock_error_us},
      {"eye_hand_ms", toJson(result.eye_hand_ns)},
      {"interferences",
       counters(loop.safety_actions, [](std::size_t i) { return kSafetyActionNames[i]; })},
      {"device", toJson(result.device)},
      {"realtime", {{"fifo", result.realtime.fifo}, {"mlock", result.realtime.mlock}}},
      {"safety_states", stateNames(loop.safety_states)},
      {"faults", faultNames(loop.faults)}};
}

}  // namespace

void writeSummary(const std::string& file, const RunResult& result) {
  std::ofstream out(file);
  // JSON has no infinity: the library writes null for a number that is not finite.
  out << summary(result).dump(2) << '\n';
  out.close();
  if (!out)
    throw std::runtime_error("--summary " + file +
                             ": cannot be written; is its folder there and writable?");
}

std::string toText(const RunResult& result) {
  const LoopStats& loop = result.loop;
  const auto microseconds = [&](double quantile) {
    return static_cast<double>(loop.tick_ns.quantile_ns(quantile)) * 1e-3;
  };
  std::string text = fmt::format(
      "{:.1f} s at 1 kHz, {} ticks late; a tick lasts {:.1f} us (median), {:.1f} us (99.9 %).\n",
      static_cast<double>(loop.ticks) * 1e-3, loop.late_ticks, microseconds(0.5),
      microseconds(0.999));
  if (loop.contact_ticks == 0) {
    text += "Nothing was touched.\n";
  } else {
    const auto interpolated = loop.contact_lookup[static_cast<std::size_t>(Lookup::kInterpolated)];
    text += fmt::format(
        "In contact for {:.0f} % of the time, {:.1f} % of it between two received frames; "
        "strongest force {:.2f} N.\n",
        100.0 * share(loop.contact_ticks, loop.ticks),
        100.0 * share(interpolated, loop.contact_ticks), loop.max_force_N);
  }
  text += fmt::format("{} frames received by {} ({} lost, {} late), playout delay {:.0f} ms.\n",
                      result.frames.received, transportName(result.delivery.transport),
                      result.frames.lost, result.frames.late, result.playout_delay_ms);
  if (result.device)
    text += fmt::format(
        "The device answered {} times; {} ticks began without an answer, {} answers were "
        "damaged.\n",
        result.device->round_trips, result.device->misses, result.device->resyncs);
  const std::string chain = chainInWords(loop);
  if (loop.step_excess_max_N != 0.0) {
    text += fmt::format("WARNING: a force step exceeded its limit by {:.3f} N.\n",
                        loop.step_excess_max_N);
  } else if (chain.empty()) {
    text += "The hand's own motion explains every force step.\n";
  }
  text += chain;
  text += statesInWords(loop.safety_states);
  const Json faults = faultNames(loop.faults);
  if (!faults.empty()) text += "Faults: " + faults.dump() + "\n";
  return text;
}

}  // namespace hapticast::client
