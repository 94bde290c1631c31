// SPDX-License-Identifier: MIT
#include "client/report/tick_log.hpp"

#include <ostream>
#include <stdexcept>
#include <utility>

#include "common/write_file.hpp"

namespace hapticast::client {

namespace {
void writeVector(std::ostream& out, const Vec3& v) {
  out << ',' << v.x() << ',' << v.y() << ',' << v.z();
}
/// Writes seconds to the microsecond, independent of the precision of the stream.
template <class Time>
void writeTime(std::ostream& out, Time time) {
  const auto us = time.time_since_epoch().count() / 1000;
  const auto size = us < 0 ? -us : us;
  const auto fraction = size % 1'000'000;
  out << (us < 0 ? "-" : "") << size / 1'000'000 << '.';
  for (std::int64_t digit = 100'000; digit > 0; digit /= 10) out << fraction / digit % 10;
}
}  // namespace

const char* lookupName(Lookup lookup) noexcept {
  return kLookupNames[static_cast<std::size_t>(lookup)];
}

const char* faultName(Fault fault) noexcept { return kFaultNames[static_cast<std::size_t>(fault)]; }

void writeReportHeading(std::ostream& out) {
  out << "t_s,media_s,x_mm,y_mm,z_mm,fx_N,fy_N,fz_N,sx_N,sy_N,sz_N,dx_N,dy_N,dz_N,penetration_mm,"
         "lookup,ahead_x_mm,ahead_y_mm,ahead_z_mm\n";
}

void writeReport(std::ostream& out, const TickReport& report) {
  writeTime(out, report.time);
  out << ',';
  writeTime(out, report.play_time);
  writeVector(out, report.hip_mm);
  writeVector(out, report.force_N);
  writeVector(out, report.static_force_N);
  writeVector(out, report.dynamic_force_N);
  out << ',' << report.penetration_mm << ',' << lookupName(report.lookup);
  writeVector(out, report.ahead_mm);
  out << '\n';
}

LogFile::LogFile(std::string file) : file_(std::move(file)) {
  requireWritable("--log", file_);
  if (file_.empty()) return;
  out_.open(file_);
  writeReportHeading(out_);
}

void LogFile::write(const TickReport& report) {
  if (out_.is_open()) writeReport(out_, report);
}

void LogFile::close() {
  if (!out_.is_open()) return;
  out_.close();
  if (!out_)
    throw std::runtime_error("--log " + file_ + ": not written completely; is the disk full?");
}

}  // namespace hapticast::client
