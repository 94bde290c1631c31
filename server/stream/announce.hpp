// SPDX-License-Identifier: MIT
// DNS-SD announcement (RFC 6763, multicast DNS) of this server on the LAN, by Avahi. Thread: the
// caller's for the object; Avahi's own for its events.
#pragma once

#include <memory>
#include <string>

#include "common/transport/asio.hpp"

namespace hapticast::server {

/// Throws AddressError if no other machine could reach a server at `address`.
void requireReachable(const asio::ip::address& address);

/// Announces one service until destruction.
class Announcer {
 public:
  /// Announces `name` (see isServiceName()). `listens`: address for viewers. `plays`: the stream's
  /// name. Never waits for avahi-daemon.
  /// Logs the announced name, another name if `name` is in use, and starts and stops of
  /// avahi-daemon.
  Announcer(std::string name, const asio::ip::tcp::endpoint& listens, const std::string& plays);
  /// Withdraws the announcement.
  ~Announcer();
  Announcer(const Announcer&) = delete;
  Announcer& operator=(const Announcer&) = delete;

 private:
  struct Service;
  std::unique_ptr<Service> service_;
};

}  // namespace hapticast::server
