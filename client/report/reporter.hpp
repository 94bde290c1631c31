// SPDX-License-Identifier: MIT
// Reports of a run: the file of --log, the fault files, log lines about the force, and the summary.
// Thread: main.
#pragma once

#include <optional>
#include <string>

#include "client/report/fault_log.hpp"
#include "client/report/messages.hpp"
#include "client/report/summary.hpp"
#include "client/report/tick_log.hpp"

namespace hapticast::client {

class Reporter {
 public:
  /// Opens the log file and the fault folder. `log_file`, `summary_file`: empty: none.
  /// `fault_folder`: empty: the state folder. Throws std::runtime_error (one line) if a file cannot
  /// be written.
  Reporter(const std::string& log_file, const std::string& fault_folder, std::string summary_file);

  /// Writes the report of a tick to the log file. Logs a line if the state of the force has
  /// changed. Sets `report.time` to the time since the first tick. Call it before `rearm` receives
  /// the report.
  void onReport(TickReport& report, const RearmPolicy& rearm);
  /// Writes a fault file if a fault has frozen `recorder`. Does nothing before the first
  /// onReport(), because the times in the file count from the first tick.
  void writeFaults(FlightRecorder& recorder);
  /// Closes the log file and writes the summary. Returns false if a file is not complete; the log
  /// has a line for each.
  [[nodiscard]] bool finish(const RunResult& run);

 private:
  LogFile log_;
  FaultLogWriter faults_;
  std::string summary_file_;
  HapticStatusLog status_;
  std::optional<LocalTime> begin_;  // of the first tick
};

}  // namespace hapticast::client
