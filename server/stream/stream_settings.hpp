// SPDX-License-Identifier: MIT
// What can be set of the stream, and what it counts. Plain values.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/time.hpp"
#include "server/stream/send_queue.hpp"

namespace hapticast::server {

struct StreamSettings {
  std::size_t max_clients = 64;                       ///< --max-clients
  Duration hello_deadline = std::chrono::seconds(5);  ///< a connection says hello by then
  Duration idle_timeout =
      std::chrono::seconds(10);  ///< a client says something (a ping) that often
  Duration write_timeout = std::chrono::seconds(5);     ///< a client takes some bytes that often
  Duration goodbye_deadline = std::chrono::seconds(1);  ///< for the peer to read why it is closed
  int send_buffer_bytes = 256 << 10;                    ///< so that a stalled client hoards little
};

/// Since the start.
struct StreamCounts {
  std::size_t clients = 0;  ///< now
  std::uint64_t welcomed = 0;
  std::uint64_t refused = 0;    ///< full, wrong version, not speaking the protocol
  std::uint64_t timed_out = 0;  ///< silent, or not reading
  SendCounts sent;              ///< over all clients
};

}  // namespace hapticast::server
