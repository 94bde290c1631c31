// SPDX-License-Identifier: MIT
#include "client/commands/replay_command.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <cstdio>
#include <optional>
#include <span>

#include "client/commands/replay_outputs.hpp"
#include "client/recording/replay.hpp"
#include "client/report/tick_log.hpp"
#include "common/cli/run_program.hpp"
#include "common/recording/progress_log.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

ReplayChanges readChanges(const Settings& settings) {
  ReplayChanges changes;
  if (settings.method_given) changes.method = settings.method;
  if (settings.surface_given) changes.surface = settings.surface;
  if (settings.stiffness_N_mm > 0.0) changes.stiffness_N_mm = settings.stiffness_N_mm;
  if (settings.stiffness_limit_N_mm > 0.0)
    changes.stiffness_limit_N_mm = settings.stiffness_limit_N_mm;
  return changes;
}

/// Renders `replay` with `changes` until `stop`, and writes the files of `settings`. Returns
/// nullopt if one of them is not complete; the log has the reason.
std::optional<ReplayCounts> writeOutputs(const Settings& settings, Replay& replay,
                                         const ReplayChanges& changes,
                                         const std::atomic<bool>& stop) {
  LogFile log(settings.log_file);
  ReplayViews views(settings);
  std::optional<ReplayRecording> recording;
  if (!settings.outputs.record.empty()) recording.emplace(settings.outputs.record);
  std::optional<LocalTime> begin;
  ReplayOutputs outputs{.stop = &stop};
  outputs.onTick = [&](const TickReport& report) {
    if (recording) recording->onTick(report);
    if (!begin) begin = report.time;
    TickReport row = report;
    row.time = LocalTime(report.time - *begin);
    log.write(row);
    views.onTick(row);
  };
  outputs.onMessage = [&](RunChannel channel, std::uint64_t time_ns,
                          std::span<const std::uint8_t> data) {
    if (recording) recording->onMessage(channel, time_ns, data);
    views.onMessage(channel, data);
  };
  const ReplayCounts counts = replay.run(changes, outputs);
  bool complete = succeed([&] { log.close(); });
  if (recording) complete = succeed([&] { recording->finish(); }) && complete;
  if (counts.ticks > 0) complete = views.finish() && complete;
  return complete ? std::optional(counts) : std::nullopt;
}

}  // namespace

int runReplay(const Settings& settings) {
  requireDistinctOutputs(settings);
  const std::string& file = settings.replay_file;
  auto opened = Replay::open(file, logScan(file));
  if (!opened.ok()) {
    spdlog::error("--replay {}: {}", file, sanitizeUtf8(opened.error().message));
    return kWrongInput;
  }
  Replay& replay = *opened.value();
  const ReplayChanges changes = readChanges(settings);
  const std::atomic<bool>& stop = stopAtSignals(SecondSignal::kEndsProgram);
  const auto rendered = writeOutputs(settings, replay, changes, stop);
  if (!rendered) return kFailed;
  const ReplayCounts& counts = *rendered;
  if (!replay.problem().empty())
    spdlog::warn("{} {}: {} ticks are rendered", file, replay.problem(), counts.ticks);
  if (counts.ticks == 0 && !stop) return kFailed;
  const std::string difference =
      counts.different == 0
          ? "all forces have the recorded bits"
          : fmt::format("{} forces differ from the recorded ones, by at most {:.3g} N",
                        counts.different, counts.largest_difference_N);
  fmt::print("{}: {} ticks; {}\n", file, counts.ticks, difference);
  return changes.any() || counts.different == 0 ? kDone : kFailed;
}

}  // namespace hapticast::client
