// SPDX-License-Identifier: MIT
// What a run leaves: the file of --log, the files of faults, lines about the force in the log, and
// the summary. Thread: main.
#pragma once

#include <optional>
#include <string>

#include "client/report/connection_log.hpp"
#include "client/report/fault_log.hpp"
#include "client/report/summary.hpp"
#include "client/report/tick_log.hpp"

namespace hapticast::client {

class Reporter {
 public:
  struct Files {
    std::string log;           ///< empty: none
    std::string fault_folder;  ///< empty: the state folder
    std::string summary;       ///< empty: none
  };
  /// Throws std::runtime_error, one line, when a file cannot be written.
  explicit Reporter(const Files& files);

  /// Logs a tick. Sets `report.time` to count from the first tick. Call before `rearm` gets the
  /// report.
  void onReport(TickReport& report, const RearmPolicy& rearm);
  /// Writes the ticks before a fault, if `recorder` is frozen by one. A fault of the very first
  /// tick waits for its report.
  void writeFaults(FlightRecorder& recorder);
  /// Closes the log and writes the summary. Throws std::runtime_error naming the file.
  void finish(const RunResult& run);

 private:
  LogFile log_;
  FaultLogWriter faults_;
  std::string summary_file_;
  HapticStatusLog status_;
  std::optional<LocalTime> begin_;  // of the first tick
};

}  // namespace hapticast::client
