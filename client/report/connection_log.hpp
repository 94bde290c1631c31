// SPDX-License-Identifier: MIT
// What a person is told of the connection: a line for what is new, none for what is known, and not
// more than a person can read, whatever the server does. Thread: one.
#pragma once

#include <optional>
#include <string>

#include "client/net/receiver.hpp"
#include "common/log_rate_limiter.hpp"

namespace hapticast::client {

/// What is said of a new connection, by a client that runs `method`.
std::string greeting(const StreamDescription& stream, Method method);

class ConnectionLog {
 public:
  /// `server`: HOST:PORT, or mdns:NAME.
  explicit ConnectionLog(std::string server) : server_(std::move(server)) {}

  /// A connection is made; `greeting` is the line for it.
  std::optional<std::string> connected(const std::string& greeting, LocalTime now);
  /// The server looks through its clip and has done this share of it: told when a quarter more is.
  std::optional<std::string> preparing(double share, LocalTime now);
  /// Something of the connection that goes on.
  std::optional<std::string> onMessage(const std::string& line, LocalTime now) {
    return limit_.admit(line, now);
  }
  /// There is no connection, because of `why`; it will be tried again.
  std::optional<std::string> lost(const std::string& why, LocalTime now);

  [[nodiscard]] bool everConnected() const { return ever_connected_; }
  /// Why there is no connection now; empty while there is one or none was tried.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  std::string server_;
  std::string reason_;
  std::optional<double> logged_share_;  // on this connection
  LogInterval lost_interval_;           // of one reason
  bool ever_connected_ = false;
  LogRateLimiter limit_;
};

/// What a stream brings that is not felt, a line a minute at most.
class StreamErrorLog {
 public:
  /// `counts`: of the run so far.
  std::optional<std::string> onCounts(const ReceiverCounts& counts, LocalTime now);

 private:
  ReceiverCounts logged_;
  LogInterval interval_;
};

}  // namespace hapticast::client
