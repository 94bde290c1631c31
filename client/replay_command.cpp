// SPDX-License-Identifier: MIT
#include "client/replay_command.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <stdexcept>

#include "client/recording/replay.hpp"
#include "client/report/tick_log.hpp"
#include "common/cli/run_program.hpp"
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

}  // namespace

int runReplay(const Settings& settings) {
  requireDistinctOutputs(settings);
  const std::string& file = settings.replay_file;
  auto opened = Replay::open(file);
  if (!opened.ok()) {
    spdlog::error("--replay {}: {}", file, sanitizeUtf8(opened.error().message));
    return kWrongInput;
  }
  Replay& replay = *opened.value();
  const ReplayChanges changes = readChanges(settings);
  LogFile log(settings.log_file);
  std::optional<LocalTime> begin;
  const ReplayCounts counts = replay.run(changes, [&](const TickReport& report) {
    if (!begin) begin = report.time;
    TickReport row = report;
    row.time = LocalTime(report.time - *begin);
    log.write(row);
  });
  log.close();
  if (!replay.problem().empty())
    spdlog::warn("{} {}: {} ticks are rendered", file, replay.problem(), counts.ticks);
  if (counts.ticks == 0) return kFailed;
  const std::string difference =
      counts.different == 0
          ? "all forces have the recorded bits"
          : fmt::format("{} forces differ from the recorded ones, by at most {:.3g} N",
                        counts.different, counts.largest_difference_N);
  fmt::print("{}: {} ticks; {}\n", file, counts.ticks, difference);
  return changes.any() || counts.different == 0 ? kDone : kFailed;
}

}  // namespace hapticast::client
