// SPDX-License-Identifier: MIT
#include "client/summary.hpp"

#include <array>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "client/log.hpp"

namespace hapticast::client {

namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// {"name": count, ...} of an array of counters.
template <std::size_t N, class Name>
std::string counters(const std::array<std::uint64_t, N>& counts, Name name) {
  std::string text = "{";
  for (std::size_t i = 0; i < N; ++i) {
    text += (i == 0 ? "\"" : ", \"") + std::string(name(i)) + "\": " + std::to_string(counts[i]);
  }
  return text + "}";
}

const char* lookupKey(std::size_t i) { return lookupName(static_cast<Lookup>(i)); }

/// ["name", ...] of the faults that were raised.
std::string faultList(const std::array<std::uint64_t, kFaultKinds>& faults) {
  std::string text = "[";
  for (std::size_t i = 1; i < faults.size(); ++i) {
    if (faults[i] == 0) continue;
    text +=
        (text.size() > 1 ? ", \"" : "\"") + std::string(faultName(static_cast<Fault>(i))) + "\"";
  }
  return text + "]";
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

}  // namespace

void writeSummary(const std::string& file, const RunResult& result) {
  const LoopStats& loop = result.loop;
  const ReceiverCounts& frames = result.frames;
  std::ofstream out(file);
  out << "{\n"
      << "  \"ticks\": " << loop.ticks << ",\n"
      << "  \"late_ticks\": " << loop.late_ticks << ",\n"
      << "  \"tick_ns\": {\"p50\": " << loop.tick_ns.quantile_ns(0.5)
      << ", \"p99\": " << loop.tick_ns.quantile_ns(0.99)
      << ", \"p999\": " << loop.tick_ns.quantile_ns(0.999) << ", \"max\": " << loop.tick_ns.max_ns()
      << "},\n"
      << "  \"frames\": {\"received\": " << frames.received << ", \"lost\": " << frames.lost
      << ", \"late\": " << frames.late << ", \"concealed\": " << frames.concealed << "},\n"
      << "  \"bytes_received\": " << result.bytes_received << ",\n"
      << "  \"lookup\": " << counters(loop.lookup, lookupKey) << ",\n"
      << "  \"contact_lookup\": " << counters(loop.contact_lookup, lookupKey) << ",\n"
      << format(
             "  \"max_force_N\": %.6g,\n  \"max_force_step_N\": %.6g,\n  \"step_excess_max_N\": "
             "%.6g,\n",
             loop.max_force_N, loop.max_force_step_N, loop.step_excess_max_N)
      << format(
             "  \"work_mJ\": {\"relative\": %.6g, \"surface\": %.6g, \"object\": %.6g, \"user\": "
             "%.6g},\n",
             loop.work.relative_mJ, loop.work.surface_mJ, loop.work.object_mJ, loop.work.user_mJ())
      << "  \"contact_ticks\": " << loop.contact_ticks << ",\n"
      << format(
             "  \"playout_delay_ms\": %.3f,\n  \"clock_offset_us\": %.3f,\n  \"clock_error_us\": "
             "%.3f,\n",
             result.playout_delay_ms, result.clock_offset_us, result.clock_error_us)
      << "  \"interferences\": "
      << counters(loop.interferences, [](std::size_t i) { return kInterferenceNames[i]; }) << ",\n"
      << "  \"realtime\": {\"fifo\": " << (result.realtime.fifo ? "true" : "false")
      << ", \"mlock\": " << (result.realtime.mlock ? "true" : "false") << "},\n"
      << "  \"faults\": " << faultList(loop.faults) << "\n}\n";
  out.close();
  if (!out)
    throw std::runtime_error("--summary " + file +
                             ": cannot be written; is its folder there and writable?");
}

std::string inWords(const RunResult& result) {
  const LoopStats& loop = result.loop;
  const auto interpolated = loop.contact_lookup[static_cast<std::size_t>(Lookup::kInterpolated)];
  std::string text = format(
      "%.1f s at 1 kHz, %llu ticks late; a tick takes %.1f us (median), %.1f us (99.9 %%).\n",
      static_cast<double>(loop.ticks) * 1e-3, static_cast<unsigned long long>(loop.late_ticks),
      static_cast<double>(loop.tick_ns.quantile_ns(0.5)) * 1e-3,
      static_cast<double>(loop.tick_ns.quantile_ns(0.999)) * 1e-3);
  if (loop.contact_ticks == 0) {
    text += "Nothing was touched.\n";
  } else {
    text += format(
        "In contact for %.0f %% of the time, %.1f %% of it between two received frames; strongest "
        "force %.2f N.\n",
        100.0 * share(loop.contact_ticks, loop.ticks),
        100.0 * share(interpolated, loop.contact_ticks), loop.max_force_N);
  }
  text += format(
      "%llu frames received (%llu lost, %llu late), played %.0f ms behind their arrival's clock.\n",
      static_cast<unsigned long long>(result.frames.received),
      static_cast<unsigned long long>(result.frames.lost),
      static_cast<unsigned long long>(result.frames.late), result.playout_delay_ms);
  text +=
      loop.step_excess_max_N == 0.0
          ? "No force step that the hand's own motion does not explain.\n"
          : format("WARNING: a force step exceeded its limit by %.3f N.\n", loop.step_excess_max_N);
  const std::string faults = faultList(loop.faults);
  if (faults != "[]") text += "Faults: " + faults + "\n";
  return text;
}

}  // namespace hapticast::client
