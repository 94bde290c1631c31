// SPDX-License-Identifier: MIT
// Connection to a NATS system, with libnats. It reconnects automatically to any server of the
// system. It drops messages that it cannot send at once, because late frames are useless. Only the
// .cpp of this header includes libnats. Thread: any, except where a function states another one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "server/relay/nats_address.hpp"

namespace hapticast::server {

/// A connection from its construction to its destruction.
class NatsConnection {
 public:
  /// Receives a message and the subject for the answer (empty: none). Thread: of libnats, a
  /// separate one for each subscription.
  using OnMessage = std::function<void(std::span<const std::uint8_t> bytes, const std::string&)>;

  /// Connects to one of the servers in `address`. `flag`: command line flag with the address, for
  /// error messages. Throws AddressError if a file is not usable, or if this build has no libnats.
  /// Throws std::runtime_error if no server answers or accepts the credentials. Each error message
  /// has one line.
  NatsConnection(const std::string& flag, const NatsAddress& address,
                 const NatsCredentials& credentials);
  /// Closes the connection. Returns after the last call of an OnMessage has returned.
  ~NatsConnection();
  NatsConnection(const NatsConnection&) = delete;
  NatsConnection& operator=(const NatsConnection&) = delete;

  /// Subscribes to `subject`, which may have wildcards. Throws AddressError if libnats fails.
  void subscribe(const std::string& subject, OnMessage on_message);
  /// Sends `bytes` to `subject`. `reply` is the subject for answers (empty: none). Returns false if
  /// libnats did not accept the message, for example because there is no connection at present or
  /// the message is too large. Blocks while the server reads nothing, for at most a second, and
  /// then returns false.
  bool publish(const std::string& subject, std::span<const std::uint8_t> bytes,
               const std::string& reply = "");
  /// Returns whether there is a connection at present.
  [[nodiscard]] bool isConnected() const;
  /// Returns whether the connection has ended for good, because the servers refuse it.
  [[nodiscard]] bool isClosed() const;
  /// Returns the largest size of a message.
  [[nodiscard]] std::size_t maxPayload() const;
  /// Returns a new subject for answers to this connection.
  [[nodiscard]] static std::string makeInbox();

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace hapticast::server
