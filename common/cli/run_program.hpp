// SPDX-License-Identifier: MIT
// The frame of both programs: logger, last catch, exit code. Thread: main.
#pragma once

#include <functional>
#include <string>

namespace hapticast {

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongInput = 2 };

/// Logs to stderr as `name` (with `quiet` only warnings and errors), calls `run`, and returns its
/// exit code. An exception of `run` becomes one line in the log and kFailed.
int runProgram(const std::string& name, bool quiet, const std::function<int()>& run);

}  // namespace hapticast
