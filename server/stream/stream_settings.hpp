// SPDX-License-Identifier: MIT
// Settings and counts of the stream. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "common/time.hpp"
#include "server/stream/send_queue.hpp"

namespace hapticast::server {

// Error of a listen or multicast address from the command line. Thread: any.

/// An address that is invalid or does not belong to this machine: a user error, unlike other
/// failures to listen. The message is one line. It begins with the flag, except for --listen.
class AddressError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Limits and deadlines of connections.
struct StreamSettings {
  std::size_t max_clients = 64;                       ///< --max-clients
  Duration hello_deadline = std::chrono::seconds(5);  ///< from connection to hello
  /// Longest silence of a client (pings count).
  Duration idle_timeout = std::chrono::seconds(10);
  /// Longest time without a byte read by a client.
  Duration write_timeout = std::chrono::seconds(5);
  /// Time for the peer to read the reason of a close.
  Duration goodbye_deadline = std::chrono::seconds(1);
  int send_buffer_bytes = 256 << 10;  ///< bounds the bytes buffered for a stalled client
};

/// Counts since the start.
struct StreamCounts {
  std::size_t clients = 0;  ///< at present
  std::uint64_t welcomed = 0;
  std::uint64_t refused = 0;    ///< server full, wrong version, or protocol violations
  std::uint64_t timed_out = 0;  ///< silent, or not reading
  SendCounts sent;              ///< sum over all clients
};

}  // namespace hapticast::server
