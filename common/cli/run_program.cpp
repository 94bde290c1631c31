// SPDX-License-Identifier: MIT
#include "common/cli/run_program.hpp"

#include <spdlog/sinks/dist_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>

#include "common/text.hpp"

namespace hapticast {

namespace {

std::atomic<bool> stop_requested{false};
static_assert(decltype(stop_requested)::is_always_lock_free, "a signal's handler sets it");

/// Returns whether systemd's journal reads stderr, and adds a time to each line itself.
bool journalReadsLog() {
  const char* const stream = std::getenv("JOURNAL_STREAM");
  struct stat file {};
  if (stream == nullptr || ::fstat(STDERR_FILENO, &file) != 0) return false;
  return stream == std::to_string(file.st_dev) + ":" + std::to_string(file.st_ino);
}

}  // namespace

const char* programVersion() { return HAPTICAST_VERSION; }

void startLog(const std::string& name) {
  spdlog::drop(name);
  const auto sinks = std::make_shared<spdlog::sinks::dist_sink_mt>();  // a LogTap adds one
  sinks->add_sink(std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(name, sinks));
  spdlog::set_pattern(journalReadsLog() ? "%l %v" : "%H:%M:%S.%e %^%l%$ %v");
}

int runProgram(bool quiet, const std::function<int()>& run) {
  if (quiet) spdlog::set_level(spdlog::level::warn);
  std::signal(SIGPIPE, SIG_IGN);  // the reader of the log may end first
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of its writer
  std::cerr.rdbuf(nullptr);       // only libraries write there, for example about a damaged picture
  int exit_code = kFailed;
  (void)succeed([&] { exit_code = run(); });
  return exit_code;
}

bool succeed(const std::function<void()>& step) {
  try {
    step();
    return true;
  } catch (const std::exception& error) {
    spdlog::error("{}", sanitizeUtf8(error.what()));
    return false;
  }
}

const std::atomic<bool>& stopAtSignals(SecondSignal second) {
  const auto stop = second == SecondSignal::kIsIgnored
                        ? +[](int /*signal*/) { stop_requested = true; }
                        : +[](int signal) {
                            stop_requested = true;
                            std::signal(signal, SIG_DFL);
                          };
  for (const int signal : {SIGINT, SIGTERM, SIGQUIT}) std::signal(signal, stop);
  if (!sighupIgnored()) std::signal(SIGHUP, stop);
  return stop_requested;
}

bool sighupIgnored() {
  struct sigaction before {};
  return ::sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

bool sighupReloads() { return !sighupIgnored() && ::isatty(STDIN_FILENO) == 0; }

}  // namespace hapticast
