// SPDX-License-Identifier: MIT
#include "client/report/reporter.hpp"

#include <spdlog/spdlog.h>

namespace hapticast::client {

Reporter::Reporter(const Files& files)
    : log_(files.log), faults_(files.fault_folder), summary_file_(files.summary) {}

void Reporter::onReport(TickReport& report, const RearmPolicy& rearm) {
  if (!begin_) begin_ = report.time;
  report.time = LocalTime(report.time - *begin_);
  log_.write(report);
  for (const std::string& line : status_.onReport(report, rearm)) spdlog::warn("{}", line);
}

void Reporter::writeFaults(FlightRecorder& recorder) {
  if (begin_) faults_.write(recorder, *begin_);
}

void Reporter::finish(const RunResult& run) {
  log_.close();
  if (!summary_file_.empty()) writeSummary(summary_file_, run);
}

}  // namespace hapticast::client
