// SPDX-License-Identifier: MIT
// Getting a channel to a server: name look-up and TCP connection, each within a deadline. Another
// transport is another function of this type. Thread: network.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/endpoint.hpp"
#include "common/time.hpp"
#include "common/transport/channel.hpp"

namespace hapticast::client {

/// What a dialling that goes on can be ended by; it comes back with an error soon after.
class DialCancellation {
 public:
  void stop() {
    stopped_ = true;
    if (on_stop_) on_stop_();
  }
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// For who dials: what to do at a stop(); an empty function takes it back.
  void onStop(std::function<void()> action) { on_stop_ = std::move(action); }

 private:
  bool stopped_ = false;
  std::function<void()> on_stop_;
};

/// Why there is no channel.
struct DialError {
  std::string message;          ///< one line, without the server's name
  bool no_such_server = false;  ///< its name does not exist
};

/// A channel that takes small messages only until its read limit is raised.
using Dialled = Result<std::unique_ptr<Channel>, DialError>;
using Dial = std::function<asio::awaitable<Dialled>(asio::io_context& io, const Endpoint& server,
                                                    Duration deadline, DialCancellation& stop)>;

/// Looks the name up and connects over TCP, each for at most `deadline` of the steady clock. (A
/// look-up cannot be interrupted: one that is too late or stopped is left behind and ends by
/// itself.) `stop` outlives the call.
asio::awaitable<Dialled> dialTcp(asio::io_context& io, const Endpoint& server, Duration deadline,
                                 DialCancellation& stop);

}  // namespace hapticast::client
