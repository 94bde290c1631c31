// SPDX-License-Identifier: MIT
// Dialling: name look-up and TCP connection, each within a deadline. Another transport is another
// function of the type `Dial`.
// Thread: network.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/endpoint.hpp"
#include "common/time.hpp"
#include "common/transport/channel.hpp"

namespace hapticast::client {

/// Cancellation of a running dial, which then returns an error soon.
class DialCancellation {
 public:
  void stop() {
    stopped_ = true;
    if (on_stop_) on_stop_();
  }
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// Sets the action of the running dial for stop(); an empty function removes it.
  void onStop(std::function<void()> action) { on_stop_ = std::move(action); }

 private:
  bool stopped_ = false;
  std::function<void()> on_stop_;
};

/// Error of a dial.
struct DialError {
  std::string message;          ///< one line, without the server's name
  bool no_such_server = false;  ///< the host name does not exist
};

/// A new channel. It accepts small messages only, until the caller raises its read limit.
using Dialled = Result<std::unique_ptr<Channel>, DialError>;
using Dial = std::function<asio::awaitable<Dialled>(asio::io_context& io, const Endpoint& server,
                                                    Duration deadline, DialCancellation& stop)>;

/// Resolves the name and connects over TCP, each for at most `deadline` of the steady clock.
/// Returns the channel or an error. A look-up cannot be interrupted: after a timeout or stop() it
/// ends by itself. `stop` must outlive the call.
asio::awaitable<Dialled> dialTcp(asio::io_context& io, const Endpoint& server, Duration deadline,
                                 DialCancellation& stop);

}  // namespace hapticast::client
