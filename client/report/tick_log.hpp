// SPDX-License-Identifier: MIT
// Tick reports as rows of a CSV file, and the file of --log.
// Thread: main.
#pragma once

#include <fstream>
#include <string>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// Returns the name of a lookup kind in the log.
const char* lookupName(Lookup lookup) noexcept;
/// Returns the name of a fault in the log.
const char* faultName(Fault fault) noexcept;

/// Writes the heading line:
/// t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,...,dz_N,penetration_mm,lookup,
/// ahead_x_mm,ahead_y_mm,ahead_z_mm
void writeReportHeading(std::ostream& out);
/// Writes the row of one report.
void writeReport(std::ostream& out, const TickReport& report);

/// A log file with a row for every tick. It is the file of --log, or one that the user requests in
/// the window.
class LogFile {
 public:
  /// Opens `file`. For an empty name the object writes nothing. Throws std::runtime_error (one
  /// line) if the file cannot be written.
  explicit LogFile(std::string file);
  /// Writes the row of one report.
  void write(const TickReport& report);
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Closes the file. Throws std::runtime_error if not all rows could be written.
  void close();

 private:
  std::string file_;
  std::ofstream out_;
};

}  // namespace hapticast::client
