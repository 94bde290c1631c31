// SPDX-License-Identifier: MIT
// The frame of both programs: logger, last catch, exit code. Thread: main.
#pragma once

#include <csignal>
#include <functional>
#include <string>

namespace hapticast {

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongInput = 2 };

/// Logs to stderr as `name` (with `quiet` only warnings and errors), calls `run`, and returns its
/// exit code. An exception of `run` becomes one line in the log and kFailed.
int runProgram(const std::string& name, bool quiet, const std::function<int()>& run);

// Inherited signal disposition of SIGHUP. Thread: main, at start-up.

/// Returns whether SIGHUP was ignored at the program's start, as nohup arranges; then it stays
/// ignored.
inline bool sighupIgnored() {
  struct sigaction before {};
  return ::sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

}  // namespace hapticast
