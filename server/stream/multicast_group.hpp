// SPDX-License-Identifier: MIT
// Multicast group on one network of this machine: one datagram reaches all members. Thread: main,
// at start-up.
#pragma once

#include <string>

#include "common/endpoint.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::server {

// The multicast group of the command line, without sockets. Thread: any.

/// A requested multicast group: GROUP:PORT[@INTERFACE].
struct MulticastChoice {
  Endpoint group;
  std::string interface;  ///< name or address; empty: the first suitable one

  bool operator==(const MulticastChoice&) const = default;
};

/// Socket that sends to one group.
class MulticastGroup {
 public:
  /// Opens a socket that sends to the group on the chosen interface. Logs the interface if several
  /// exist and none was chosen. `hops`: time to live.
  /// Throws AddressError, or std::runtime_error if the system rejects the group, with one line that
  /// begins with --multicast.
  MulticastGroup(asio::io_context& io, const MulticastChoice& choice, int hops);

  [[nodiscard]] asio::ip::udp::socket& socket() { return socket_; }
  [[nodiscard]] const asio::ip::udp::endpoint& endpoint() const { return endpoint_; }

 private:
  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint endpoint_;
};

}  // namespace hapticast::server
