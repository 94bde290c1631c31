// SPDX-License-Identifier: MIT
// Multicast group on one network of this machine: one datagram of the server reaches all members.
// Thread: main, at start-up.
#pragma once

#include <string>

#include "common/endpoint.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::server {

/// A multicast group that the author requests on the command line: GROUP:PORT[@INTERFACE]. Needs no
/// sockets. Thread: any.
struct MulticastChoice {
  Endpoint group;
  std::string interface;  ///< network interface, by name or address; empty: the first suitable one

  bool operator==(const MulticastChoice&) const = default;
};

/// Socket that sends to one multicast group.
class MulticastGroup {
 public:
  /// Opens a socket that sends to the group on the chosen interface. It logs the interface if none
  /// was chosen and several exist. `hops`: time to live (TTL) of the datagrams. Throws
  /// AddressError, or std::runtime_error if the system rejects the group. The message has one line
  /// that begins with --multicast.
  MulticastGroup(asio::io_context& io, const MulticastChoice& choice, int hops);

  [[nodiscard]] asio::ip::udp::socket& socket() { return socket_; }
  [[nodiscard]] const asio::ip::udp::endpoint& endpoint() const { return endpoint_; }

 private:
  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint endpoint_;
};

}  // namespace hapticast::server
