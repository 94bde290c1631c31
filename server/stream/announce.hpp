// SPDX-License-Identifier: MIT
// Announces this server on the LAN by DNS-SD over multicast DNS (RFC 6763), through Avahi. Viewers
// can then find it by name. Thread: the caller's for the object; Avahi's own for its events.
#pragma once

#include <memory>
#include <string>

#include "common/transport/asio.hpp"

namespace hapticast::server {

/// Checks that other machines can reach a server that listens at `address`. Throws AddressError if
/// they cannot (for example, at 127.0.0.1).
void requireReachable(const asio::ip::address& address);

/// Announces one server from its construction to its destruction.
class Announcer {
 public:
  /// Begins to announce `name` (see isServiceName()) with the address `listen_endpoint`, at which
  /// viewers connect, the stream's name `stream_name`, and the fingerprint of the TLS certificate
  /// (hex; empty: no TLS). `has_page`: browsers get a page there, so it also announces a web site
  /// (_http._tcp, with TLS _https._tcp). It does not wait for avahi-daemon. It logs the announced
  /// name, which differs from `name` if another server on the LAN has this name. It also logs when
  /// avahi-daemon starts and stops.
  Announcer(std::string name, const asio::ip::tcp::endpoint& listen_endpoint,
            const std::string& stream_name, const std::string& tls_fingerprint, bool has_page);
  /// Ends the announcement.
  ~Announcer();
  Announcer(const Announcer&) = delete;
  Announcer& operator=(const Announcer&) = delete;

 private:
  struct Service;
  std::unique_ptr<Service> service_;
};

}  // namespace hapticast::server
