// SPDX-License-Identifier: MIT
// Log lines about the connection: one line for each change, with a rate limit against any behaviour
// of the server.
// Thread: one (main).
#pragma once

#include <optional>
#include <string>

#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/net/receiver.hpp"
#include "common/log_rate_limiter.hpp"

namespace hapticast::client {

/// Returns the line for a new connection. `method` is the client's.
std::string greeting(const StreamDescription& stream, Method method);

/// State of the lines about the connection. Each function returns a line, or nullopt if there is
/// nothing new.
class ConnectionLog {
 public:
  /// `server` is HOST:PORT or mdns:NAME.
  explicit ConnectionLog(std::string server) : server_(std::move(server)) {}

  /// A connection exists. `greeting` is its line.
  std::optional<std::string> connected(const std::string& greeting, LocalTime now);
  /// The server has prepared this share (0..1) of its clip. Logged in steps of a quarter.
  std::optional<std::string> preparing(double share, LocalTime now);
  /// An event of the present connection.
  std::optional<std::string> onMessage(const std::string& line, LocalTime now) {
    return limit_.admit(line, now);
  }
  /// There is no connection because of `why`; a retry follows.
  std::optional<std::string> lost(const std::string& why, LocalTime now);

  [[nodiscard]] bool everConnected() const { return ever_connected_; }
  /// Reason of the missing connection; empty with a connection, and before the first attempt.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  std::string server_;
  std::string reason_;
  std::optional<double> logged_share_;  // of this connection
  LogInterval lost_interval_;           // for reason_
  bool ever_connected_ = false;
  LogRateLimiter limit_;
};

/// Log lines about defects of the stream, at most one per minute.
class StreamErrorLog {
 public:
  /// Returns a line if `counts` (of the whole run) has new defects.
  std::optional<std::string> onCounts(const ReceiverCounts& counts, LocalTime now);

 private:
  ReceiverCounts logged_;
  LogInterval interval_;
};

// Log lines about the force during a run: a halt and its cause, the return of the force, a softer
// wall. One line for each change.
// Thread: main.

/// State of the lines about the force.
class HapticStatusLog {
 public:
  /// Processes every report in order and returns a line if there is something new. Call it before
  /// rearm.onReport(): `rearm` states whether re-arming is automatic.
  std::optional<std::string> onReport(const TickReport& report, const RearmPolicy& rearm);

 private:
  [[nodiscard]] std::string describeStatus(const TickReport& report);

  Halt halt_ = Halt::kNone;
  bool stale_ = false;
  bool logged_enable_ = false;  // logged once a run
  LogInterval softer_;
  LogInterval later_;
  LogRateLimiter limit_;
  LogRateLimiter halt_limit_;  // separate, so that a stream cannot suppress lines about a halt
};

}  // namespace hapticast::client
