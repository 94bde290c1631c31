// SPDX-License-Identifier: MIT
// Log lines about the connection, the stream and the force. There is one line for each change. A
// rate limit prevents a server from filling the log.
// Thread: network (ConnectionLog, StreamErrorLog), main (HapticStatusLog).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/net/receiver.hpp"
#include "common/rate_limiter.hpp"

namespace hapticast::client {

/// Returns the log line for a new connection. `method` is the method of this client.
std::string greeting(const StreamDescription& stream, Method method);

/// Log lines about the connection. Each function returns the line to log, or nullopt if there is
/// nothing new. To detect changes, the object stores the last logged values.
class ConnectionLog {
 public:
  /// `server` is the name of the server (nameServer()).
  explicit ConnectionLog(std::string server) : server_(std::move(server)) {}

  /// Call it when a connection begins. `greeting` is the line to log.
  std::optional<std::string> connected(const std::string& greeting, LocalTime now);
  /// Call it when the server has scanned the share `share` (0..1) of its clip. It returns a line
  /// for each further quarter.
  std::optional<std::string> preparing(double share, LocalTime now);
  /// Call it for an event of the present connection. `line` describes the event.
  std::optional<std::string> onMessage(const std::string& line, LocalTime now) {
    return limit_.admit(line, now);
  }
  /// Call it when a connection or an attempt has failed for the reason `why`, and a retry follows.
  std::optional<std::string> logLoss(const std::string& why, LocalTime now);

  [[nodiscard]] bool everConnected() const { return ever_connected_; }
  /// Returns the reason why there is no connection. It is empty during a connection, and before the
  /// first attempt.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  std::string server_;
  std::string reason_;
  std::optional<double> logged_share_;                          // of this connection
  RateLimiter lost_interval_ = RateLimiter::makeOnceAMinute();  // for reason_
  bool ever_connected_ = false;
  RateLimiter limit_;
};

/// Log lines about defects of the stream. There is at most one line per minute.
class StreamErrorLog {
 public:
  /// Returns a line if `counts` has new defects since the last line. `counts` has the counters of
  /// the whole run.
  std::optional<std::string> onCounts(const ReceiverCounts& counts, LocalTime now);

 private:
  ReceiverCounts logged_;
  RateLimiter interval_ = RateLimiter::makeOnceAMinute();
};

/// Log line about frames that arrive later than the largest playout delay (--max-delay) allows.
class LateFrameLog {
 public:
  explicit LateFrameLog(double max_delay_ms) : max_delay_ms_(max_delay_ms) {}

  /// Returns a line if most frames of the last second were too late, at most once a minute.
  /// `counts` has the counters of the whole run. Call it after each frame.
  std::optional<std::string> onCounts(const ReceiverCounts& counts, LocalTime now);

 private:
  double max_delay_ms_;
  ReceiverCounts second_;  // counters at the begin of the second
  std::optional<LocalTime> second_begin_;
  RateLimiter interval_ = RateLimiter::makeOnceAMinute();
};

/// Log lines about the force during a run: a halt and its cause, the return of the force, a softer
/// wall, and the safety states. The object compares each report with the last logged values, and
/// returns a line only for a change. No rate limiter applies to halts and safety states.
class HapticStatusLog {
 public:
  /// Processes the report of one tick. Returns the lines to log.
  /// Call it for every report in order, and before rearm.onReport(). `rearm` is the policy of
  /// re-arming; the line for a halt describes when the force returns.
  std::vector<std::string> onReport(const TickReport& report, const RearmPolicy& rearm);

 private:
  void addStates(const TickReport& report, std::vector<std::string>& lines);
  void addHalt(const TickReport& report, const RearmPolicy& rearm, std::vector<std::string>& lines);
  [[nodiscard]] std::string describeStatus(const TickReport& report);

  Halt halt_ = Halt::kNone;
  bool lost_before_ = false;  // the last halt was that of a lost device
  bool flaps_ = false;        // no line describes the present halt
  bool stale_ = false;
  bool logged_enable_ = false;            // logged once a run
  std::optional<LocalTime> empty_since_;  // no frame since then
  bool logged_empty_ = false;
  std::optional<LocalTime> deep_since_;  // the hand is too deep for a force since then
  RateLimiter deep_ = RateLimiter::makeOnceAMinute();
  RateLimiter softer_ = RateLimiter::makeOnceAMinute();
  RateLimiter later_ = RateLimiter::makeOnceAMinute();
  std::uint32_t states_ = 0;  // safety states of the last report
  RateLimiter limit_;
};

}  // namespace hapticast::client
