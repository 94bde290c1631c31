// SPDX-License-Identifier: MIT
// Copies the lines of the program's log (startLog()), for example to a recording.
#pragma once

#include <spdlog/common.h>

#include <functional>
#include <string_view>

namespace hapticast {

/// Passes each line of the log on, from its construction to its destruction. Programs without
/// startLog() pass no lines on. Thread: the owner's.
class LogTap {
 public:
  /// Receives a line. Thread: any, one line at a time. It must not log.
  using OnLine = std::function<void(spdlog::level::level_enum level, std::string_view text)>;

  explicit LogTap(OnLine on_line);
  ~LogTap();
  LogTap(const LogTap&) = delete;
  LogTap& operator=(const LogTap&) = delete;

 private:
  spdlog::sink_ptr sink_;
};

}  // namespace hapticast
