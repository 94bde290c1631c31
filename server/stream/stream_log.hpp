// SPDX-License-Identifier: MIT
// The lines of the log about a stream, its viewers and its connections. Each kind of line has a
// limit, so that other hosts cannot fill the log. Thread: the network's.
#pragma once

#include <spdlog/common.h>

#include <cstdint>
#include <string_view>

#include "common/rate_limiter.hpp"
#include "common/time.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

class StreamLog {
 public:
  /// Logs `line`, unless a limit is reached: 10 warnings a minute, and 10 other lines a minute.
  /// Returns whether the line was written.
  bool log(spdlog::level::level_enum level, std::string_view line, LocalTime now);
  /// Logs how many lines the limit suppressed, unless a later line has reported it. `ends`: no line
  /// follows.
  void logHidden(LocalTime now, bool ends);
  // Each of these logs one line at most once a minute, with the counts since its last line.
  /// `dropped`: frames that were too old, since the begin.
  void logStaleFrames(std::uint64_t dropped, LocalTime now);
  void logSlowViewers(const StreamCounts& all, LocalTime now);
  void logDatagrams(const DatagramSenderCounts& all, LocalTime now);
  /// Logs a frame that exceeds the limit of a message (`too_large`), or of datagrams.
  void logLargeFrame(std::size_t bytes, bool too_large, LocalTime now);

 private:
  SendCounts logged_;  // last logged counts of slow viewers
  DatagramSenderCounts logged_datagrams_;
  std::uint64_t logged_stale_ = 0;
  RateLimiter stale_interval_ = RateLimiter::makeOnceAMinute();
  RateLimiter slow_interval_ = RateLimiter::makeOnceAMinute();
  RateLimiter large_interval_ = RateLimiter::makeOnceAMinute();
  RateLimiter datagrams_interval_ = RateLimiter::makeOnceAMinute();
  RateLimiter others_;  // separate, so that many viewers do not hide problems
  RateLimiter problems_;
};

}  // namespace hapticast::server
