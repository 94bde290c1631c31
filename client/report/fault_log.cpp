// SPDX-License-Identifier: MIT
#include "client/report/fault_log.hpp"

#include <fmt/chrono.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "client/report/tick_log.hpp"
#include "common/private_file.hpp"

namespace hapticast::client {

namespace {

bool makeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return ::access(folder.c_str(), W_OK | X_OK) == 0 && std::filesystem::is_directory(folder, error);
}

}  // namespace

FaultLogWriter::FaultLogWriter(const std::string& folder)
    : folder_(folder.empty() ? stateFolder() : std::filesystem::path(folder)) {
  if (folder.empty() || makeFolder(folder_)) return;
  throw std::runtime_error("--fault-dir " + folder +
                           ": is not a writable folder and cannot be created; name another folder");
}

std::filesystem::path FaultLogWriter::nextFile() {
  const std::string time = fmt::format("{:%Y%m%dT%H%M%SZ}", fmt::gmtime(std::time(nullptr)));
  std::filesystem::path file;
  std::error_code error;
  int number = ++written_;
  do {  // another client may have written a file at the same moment
    file = folder_ / fmt::format("hapticast-fault-{}-{}.csv", time, number++);
  } while (std::filesystem::exists(file, error));
  return file;
}

void FaultLogWriter::write(FlightRecorder& recorder, LocalTime begin) {
  if (!recorder.frozen() || written_ == kMaxFiles) return;
  const Fault fault = recorder.at(recorder.size() - 1).fault;
  (void)makeFolder(folder_);
  const std::filesystem::path file = nextFile();
  std::ofstream out(file);
  dumpRecorder(out, recorder, begin);
  out.close();
  if (out) {
    spdlog::warn("fault: {}; the ticks before it are in {}", faultName(fault), file.string());
    return;
  }
  spdlog::warn("fault: {}; {} cannot be written (--fault-dir names another folder)",
               faultName(fault), file.string());
  written_ = kMaxFiles;  // one message is enough
}

void dumpRecorder(std::ostream& out, FlightRecorder& recorder, LocalTime begin) {
  writeReportHeading(out);
  for (std::size_t i = 0; i < recorder.size(); ++i) {
    TickReport report = recorder.at(i);
    report.time = LocalTime(report.time - begin);
    writeReport(out, report);
  }
  recorder.rearm();
}

}  // namespace hapticast::client
