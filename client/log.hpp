// SPDX-License-Identifier: MIT
// Reports of the loop as rows of text: the file of --log, and the ticks before a fault. Thread:
// main.
#pragma once

#include <fstream>
#include <string>

#include "client/haptics/flight_recorder.hpp"

namespace hapticast::client {

const char* lookupName(Lookup lookup) noexcept;
const char* faultName(Fault fault) noexcept;

/// The columns: t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,...,dz_N,penetration_mm,lookup
void writeReportHeading(std::ostream& out);
void writeReport(std::ostream& out, const TickReport& report);

/// The file of --log: a row for every tick.
class LogFile {
 public:
  /// `file` may be empty: then nothing is written. Throws std::runtime_error, one line, when it
  /// cannot be written.
  explicit LogFile(std::string file);
  void write(const TickReport& report);
  /// Throws std::runtime_error when not all rows could be written.
  void close();

 private:
  std::string file_;
  std::ofstream out_;
};

/// The files of the ticks before a fault, hapticast-fault-N.csv in the working folder.
class FaultFiles {
 public:
  /// Chosen: who needs more than these has seen enough.
  static constexpr int kMaxFiles = 10;
  /// Writes a file if `recorder` is frozen by a fault, says so in the log, and lets it record
  /// again. Beyond kMaxFiles it does nothing.
  void take(FlightRecorder& recorder);

 private:
  int written_ = 0;
};

/// Writes a frozen recorder's ticks, oldest first, and lets it record again. Requires frozen().
void dumpRecorder(std::ostream& out, FlightRecorder& recorder);

}  // namespace hapticast::client
