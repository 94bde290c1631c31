// SPDX-License-Identifier: MIT
// Dialling: looks up the host name of a server and connects to the server over TCP, with or without
// TLS. Each step has a time limit. For another kind of connection, write another function of the
// type `Dial`.
// Thread: network.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/endpoint.hpp"
#include "common/time.hpp"
#include "common/transport/channel.hpp"
#include "common/transport/tls.hpp"

namespace hapticast::client {

/// Cancels a running dial. The dial then returns an error soon.
class DialCancellation {
 public:
  void stop() {
    stopped_ = true;
    if (on_stop_) on_stop_();
  }
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// Sets the function with which stop() cancels the running dial. An empty function removes it.
  void onStop(std::function<void()> action) { on_stop_ = std::move(action); }

 private:
  bool stopped_ = false;
  std::function<void()> on_stop_;
};

/// Error of a dial.
struct DialError {
  std::string message;          ///< one line, without the server's name
  bool no_such_server = false;  ///< the host name does not exist
  bool untrusted = false;       ///< the client does not trust the server's certificate
};

/// Result of a dial: a new channel or an error. At first the channel accepts small messages only;
/// the caller has to raise its read limit.
using Dialled = Result<std::unique_ptr<Channel>, DialError>;
using Dial = std::function<asio::awaitable<Dialled>(asio::io_context& io, const Endpoint& server,
                                                    Duration deadline, DialCancellation& stop)>;

/// Looks up the server's name and connects over TCP. Each step lasts at most `deadline` of the
/// steady clock. Returns the channel or an error. A running look-up cannot be interrupted. So after
/// a timeout or stop() the function returns an error at once, and the look-up ends later without
/// effect. `stop` must outlive the call.
asio::awaitable<Dialled> dialTcp(asio::io_context& io, const Endpoint& server, Duration deadline,
                                 DialCancellation& stop);

/// Returns a dial function like dialTcp() that also completes a TLS handshake, within another
/// `deadline`. `check` checks the server's fingerprint and may be empty. If `check` refuses the
/// fingerprint, or if `context` does not trust the certificate, the error has `untrusted` set.
[[nodiscard]] Dial makeTlsDial(TlsContext context, FingerprintCheck check);

}  // namespace hapticast::client
