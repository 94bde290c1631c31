// SPDX-License-Identifier: MIT
// The outermost code of both programs: it starts the log, catches every exception that no other
// code caught, and determines the exit code. Thread: main.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace hapticast {

enum ExitCode : int { kDone = 0, kFailed = 1, kWrongInput = 2 };

/// Returns the version of both programs, for example 0.1.0. Thread: any.
[[nodiscard]] const char* programVersion();

/// Starts the log of the program `name`. Its lines go to stderr: "HH:MM:SS.mmm LEVEL TEXT", where
/// LEVEL is info, warning or error. If systemd's journal reads stderr ($JOURNAL_STREAM), the lines
/// have no time, because the journal adds one.
void startLog(const std::string& name);

/// Calls `run`, and returns the exit code of `run`. If `quiet` is true, only warnings and errors
/// are logged. If `run` throws an exception, its message becomes one line in the log, and the exit
/// code is kFailed.
int runProgram(bool quiet, const std::function<int()>& run);

/// Calls `step`. Returns true if it succeeds. Its exception becomes one line in the log.
[[nodiscard]] bool succeed(const std::function<void()>& step);

/// What a second signal does after stopAtSignals(). A device's force has to come down first, so
/// the client ignores it.
enum class SecondSignal : std::uint8_t { kIsIgnored, kEndsProgram };

/// From now on SIGINT, SIGTERM, SIGQUIT and SIGHUP (unless sighupIgnored()) end no program. Returns
/// a flag that such a signal sets: the program has to end soon. `second`: what the next one does.
[[nodiscard]] const std::atomic<bool>& stopAtSignals(
    SecondSignal second = SecondSignal::kIsIgnored);

/// Returns true if the program was started with SIGHUP ignored, as nohup arranges. The program then
/// has to ignore it as well. Thread: main, at start-up.
[[nodiscard]] bool sighupIgnored();

/// Returns true if SIGHUP asks the program to read its configuration again: standard input is no
/// terminal, and the program was not started with SIGHUP ignored. On a terminal SIGHUP means that
/// the terminal closed.
[[nodiscard]] bool sighupReloads();

}  // namespace hapticast
