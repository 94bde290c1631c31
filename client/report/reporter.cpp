// SPDX-License-Identifier: MIT
#include "client/report/reporter.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "common/cli/run_program.hpp"
#include "common/write_file.hpp"

namespace hapticast::client {

Reporter::Reporter(const std::string& log_file, const std::string& fault_folder,
                   std::string summary_file)
    : log_(log_file), faults_(fault_folder), summary_file_(std::move(summary_file)) {
  requireWritable("--summary", summary_file_);
}

void Reporter::onReport(TickReport& report, const RearmPolicy& rearm) {
  if (!begin_) begin_ = report.time;
  report.time = LocalTime(report.time - *begin_);
  log_.write(report);
  for (const std::string& line : status_.onReport(report, rearm)) spdlog::warn("{}", line);
}

void Reporter::writeFaults(FlightRecorder& recorder) {
  if (begin_) faults_.write(recorder, *begin_);
}

bool Reporter::finish(const RunResult& run) {
  const bool is_logged = succeed([this] { log_.close(); });
  return (summary_file_.empty() || succeed([&] { writeSummary(summary_file_, run); })) && is_logged;
}

}  // namespace hapticast::client
