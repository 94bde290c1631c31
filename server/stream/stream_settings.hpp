// SPDX-License-Identifier: MIT
// Settings and counts of the stream. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/transport/tcp_port.hpp"
#include "server/stream/send_queue.hpp"

namespace hapticast::server {

/// Limits and deadlines of connections.
struct StreamSettings {
  std::size_t max_clients = 64;                       ///< largest number of clients (--max-clients)
  Duration hello_deadline = std::chrono::seconds(5);  ///< longest time from connection to hello
  /// Longest time without a message from a client. Pings are messages too.
  Duration idle_timeout = std::chrono::seconds(10);
  /// Longest time in which a client reads no byte while data waits for it.
  Duration write_timeout = std::chrono::seconds(5);
  /// Longest time from the message with the reason of a close to the end of the connection. In this
  /// time the client can read the message.
  Duration goodbye_deadline = std::chrono::seconds(1);
  /// Longest time of an answer to a request of HTTP. 400 kB arrive in it at 7 kB/s. Within it the
  /// client must read a byte each write_timeout.
  Duration answer_deadline = std::chrono::seconds(60);
  /// Largest number of connections that are no viewers: they have sent no hello yet, or they close.
  /// Without TLS and page, a stream without attacks always has fewer than the default.
  std::size_t max_pending = 32;
  /// Largest number of requests of HTTP that are answered at the same time. Chosen: 300 phones open
  /// six connections each, as browsers do, and a reserve.
  std::size_t max_answers = 2400;
  /// Whether viewers of other machines may connect without TLS although the server needs tokens.
  bool insecure = false;
  /// Limit of the bytes that wait in the system for a client that does not read.
  int send_buffer_bytes = 256 << 10;
  /// Limit of the bytes that wait in the system because the link is slow (TCP_NOTSENT_LOWAT). What
  /// waits longer waits in the queue, where newer frames replace it. Chosen: a large key frame.
  int unsent_bytes = 16 << 10;
};

/// Counts of clients and sent items since the server's start.
struct StreamCounts {
  std::size_t clients = 0;     ///< present number of clients
  std::size_t websockets = 0;  ///< those of them that are connected by a WebSocket
  std::uint64_t welcomed = 0;
  /// Number of clients that were refused: the server was full, their version was wrong, or they
  /// violated the protocol.
  std::uint64_t refused = 0;
  std::uint64_t timed_out = 0;     ///< number of clients that sent no messages or read nothing
  SendCounts sent;                 ///< sum over all clients
  std::uint64_t bytes = 0;         ///< bytes written to all clients, including the framing
  std::uint64_t frames = 0;        ///< published to the clients, whether or not there were any
  std::uint64_t frames_stale = 0;  ///< dropped by StaleFrameFilter
  Duration delay{0};               ///< of the newest frame, from its capture to its publication
  std::optional<LocalTime> published_at;  ///< time of the newest frame; nullopt: none yet
};

}  // namespace hapticast::server
