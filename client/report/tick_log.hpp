// SPDX-License-Identifier: MIT
// Reports of the loop as rows of text, and the file of --log. Thread: main.
#pragma once

#include <fstream>
#include <string>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

const char* lookupName(Lookup lookup) noexcept;
const char* faultName(Fault fault) noexcept;

/// The columns: t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,...,dz_N,penetration_mm,lookup
void writeReportHeading(std::ostream& out);
void writeReport(std::ostream& out, const TickReport& report);

/// The file of --log, or one asked for in the window: a row for every tick.
class LogFile {
 public:
  /// `file` may be empty: then nothing is written. Throws std::runtime_error, one line, when it
  /// cannot be written.
  explicit LogFile(std::string file);
  void write(const TickReport& report);
  [[nodiscard]] const std::string& file() const { return file_; }
  /// Throws std::runtime_error when not all rows could be written.
  void close();

 private:
  std::string file_;
  std::ofstream out_;
};

}  // namespace hapticast::client
