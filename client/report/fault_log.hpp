// SPDX-License-Identifier: MIT
// The files of the ticks before a fault. Thread: main.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/haptics/flight_recorder.hpp"

namespace hapticast::client {

/// $XDG_STATE_HOME/hapticast, else ~/.local/state/hapticast; without a home the working folder.
[[nodiscard]] std::filesystem::path stateFolder();

/// Files hapticast-fault-TIME-N.csv, TIME as 20261122T161500Z: what one run leaves, no other
/// overwrites.
class FaultLogWriter {
 public:
  /// Chosen: who needs more than these has seen enough.
  static constexpr int kMaxFiles = 10;

  /// `folder` (--fault-dir) is made at once; throws std::runtime_error, one line, when nothing can
  /// be written there. Empty: stateFolder(), made when it is needed.
  explicit FaultLogWriter(const std::string& folder);
  /// Writes a file if `recorder` is frozen by a fault, says so in the log, and lets it record
  /// again. `begin`: the run's first tick, t_s = 0. Beyond kMaxFiles, and when there is no writing,
  /// it does nothing.
  void write(FlightRecorder& recorder, LocalTime begin);

 private:
  [[nodiscard]] std::filesystem::path nextFile();

  std::filesystem::path folder_;
  int written_ = 0;
};

/// Writes a frozen recorder's ticks, oldest first, and lets it record again. Requires frozen().
void dumpRecorder(std::ostream& out, FlightRecorder& recorder, LocalTime begin);

}  // namespace hapticast::client
