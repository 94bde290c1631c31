// SPDX-License-Identifier: MIT
// Tells the LAN of this server, by Avahi. Thread: the caller's for the object, a library's own for
// what happens.
#pragma once

#include <memory>
#include <string>

#include "common/transport/asio.hpp"

namespace hapticast::server {

/// Throws AddressError where nobody else could reach what listens there.
void requireReachable(const asio::ip::address& address);

class Announcer {
 public:
  /// `name`: isServiceName(). `listens`: where viewers connect. `plays`: the stream's name. Logs
  /// by which name it is announced, another one where that is taken, and when avahi-daemon comes
  /// and goes; it is never waited for.
  Announcer(std::string name, const asio::ip::tcp::endpoint& listens, const std::string& plays);
  /// Withdraws it.
  ~Announcer();
  Announcer(const Announcer&) = delete;
  Announcer& operator=(const Announcer&) = delete;

 private:
  struct Service;
  std::unique_ptr<Service> service_;
};

}  // namespace hapticast::server
