// SPDX-License-Identifier: MIT
// Fault files: the ticks before a fault, from the flight recorder.
// Thread: main.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/haptics/flight_recorder.hpp"

namespace hapticast::client {

/// Returns $XDG_STATE_HOME/hapticast, else ~/.local/state/hapticast, else (without $HOME) the
/// working folder.
[[nodiscard]] std::filesystem::path stateFolder();

/// Writes files hapticast-fault-TIME-N.csv with TIME like 20261122T161500Z. No run overwrites the
/// files of another.
class FaultLogWriter {
 public:
  /// Files of one run. Chosen: more files bring nothing new.
  static constexpr int kMaxFiles = 10;

  /// `folder` (--fault-dir) is created at once. Throws std::runtime_error (one line) if it is not
  /// writable. Empty: stateFolder(), created on demand.
  explicit FaultLogWriter(const std::string& folder);
  /// If a fault froze `recorder`: writes a file, logs its name, and re-arms the recorder. `begin`
  /// is the first tick of the run (t_s = 0). Does nothing beyond kMaxFiles, and after a failed
  /// write.
  void write(FlightRecorder& recorder, LocalTime begin);

 private:
  [[nodiscard]] std::filesystem::path nextFile();

  std::filesystem::path folder_;
  int written_ = 0;
};

/// Writes the ticks of a frozen recorder, oldest first, and re-arms it. Requires frozen().
void dumpRecorder(std::ostream& out, FlightRecorder& recorder, LocalTime begin);

}  // namespace hapticast::client
