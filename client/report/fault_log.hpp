// SPDX-License-Identifier: MIT
// Fault files: CSV files with the ticks before a fault. The ticks are those of the flight recorder.
// Thread: main.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/haptics/flight_recorder.hpp"

namespace hapticast::client {

/// Writes fault files with names hapticast-fault-TIME-N.csv, where TIME looks like
/// 20261122T161500Z. No run overwrites the files of another run.
class FaultLogWriter {
 public:
  /// Largest number of files of one run. The value is a choice: further files rarely contain new
  /// information.
  static constexpr int kMaxFiles = 10;

  /// Creates the folder `folder` (--fault-dir) at once. Throws std::runtime_error (one line) if no
  /// file can be written in it. For an empty `folder` it uses stateFolder(), which the first file
  /// creates.
  explicit FaultLogWriter(const std::string& folder);
  /// Checks whether a fault has frozen `recorder`. If so, it writes the ticks to a file, logs the
  /// file's name, and re-arms the recorder. `begin` is the time of the first tick of the run (t_s =
  /// 0). Does nothing after kMaxFiles files, or after a failed write.
  void write(FlightRecorder& recorder, LocalTime begin);

 private:
  [[nodiscard]] std::filesystem::path nextFile();

  std::filesystem::path folder_;
  int written_ = 0;
};

/// Writes the ticks of a frozen recorder to `out`, the oldest first. Then re-arms the recorder.
/// Requires recorder.frozen().
void dumpRecorder(std::ostream& out, FlightRecorder& recorder, LocalTime begin);

}  // namespace hapticast::client
