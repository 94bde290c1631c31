// SPDX-License-Identifier: MIT
// Processes the messages of a server without a connection: a program or a web page has received
// their bytes on its own way. It checks the protocol's version, the order of messages, the server's
// key and the signatures, and passes times and frames to a Receiver. Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "client/net/origin_pin.hpp"
#include "client/net/receiver.hpp"
#include "client/net/welcome_limiter.hpp"
#include "common/protocol/messages.hpp"

namespace hapticast::client {

/// The client's end of a session, without the sending.
class MessageReceiver {
 public:
  /// `receiver` must outlive this object. `origin` checks the key of each welcome.
  explicit MessageReceiver(Receiver& receiver, OriginPin origin = {})
      : receiver_(receiver), origin_(std::move(origin)) {}

  /// Processes a message with the bytes `bytes` that arrived at `now`. Returns the message; the
  /// frame in it is empty, because the receiver has it. Returns an error if the message is invalid,
  /// or if it is the server's error. The session has ended then.
  [[nodiscard]] Result<Message, WireError> receive(std::span<const std::uint8_t> bytes,
                                                   LocalTime now);
  /// Ends the session, so that the next message has to be a welcome.
  void disconnect(LocalTime now);

  [[nodiscard]] bool welcomed() const { return welcomed_; }
  /// Returns whether the last error was a server with another key than expected.
  [[nodiscard]] bool untrusted() const { return untrusted_; }

 private:
  [[nodiscard]] std::optional<WireError> process(Message& message,
                                                 std::span<const std::uint8_t> bytes,
                                                 LocalTime now);
  [[nodiscard]] std::optional<WireError> onWelcome(const Welcome& welcome, LocalTime now);

  Receiver& receiver_;
  OriginPin origin_;
  bool welcomed_ = false;
  bool untrusted_ = false;
  RateLimiter welcomes_ = makeWelcomeLimiter();
  std::optional<VerifyingKey> key_;  // absent: the server signs nothing
  std::uint32_t stream_ = 0;
};

}  // namespace hapticast::client
