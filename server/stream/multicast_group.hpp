// SPDX-License-Identifier: MIT
// A multicast group on one of this machine's networks: one datagram for all who listen there.
// Thread: main, at start-up.
#pragma once

#include "common/transport/asio.hpp"
#include "server/stream/multicast_choice.hpp"

namespace hapticast::server {

class MulticastGroup {
 public:
  /// Opens a socket that sends to the group on that interface, whose name is told in the log where
  /// it was not asked for and there are several. Throws AddressError with one line that begins with
  /// --multicast.
  MulticastGroup(asio::io_context& io, const MulticastChoice& choice, int hops);

  [[nodiscard]] asio::ip::udp::socket& socket() { return socket_; }
  [[nodiscard]] const asio::ip::udp::endpoint& endpoint() const { return endpoint_; }

 private:
  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint endpoint_;
};

}  // namespace hapticast::server
