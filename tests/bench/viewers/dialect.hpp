// SPDX-License-Identifier: MIT
// How frames stand on the connection between a server and its viewers, ours and others'. Pure but
// for greet(). Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hapticast::testing {

enum class Transport {
  kTcp,
  kUdp,
  kWebSocket,
  kPlainTcp,  ///< frames unasked, with this machine's steady clock as their media time
  kPlainUdp,  ///< the same as datagrams, to whoever has sent one
  kMqtt,
  kNats,
};

/// Whether it speaks the protocol, with hello and pings.
[[nodiscard]] constexpr bool ours(Transport way) {
  return way == Transport::kTcp || way == Transport::kUdp || way == Transport::kWebSocket;
}
[[nodiscard]] constexpr bool byDatagrams(Transport way) {
  return way == Transport::kUdp || way == Transport::kPlainUdp;
}

/// A message on a TCP stream.
struct Envelope {
  std::size_t head = 0;  ///< bytes before its payload
  std::size_t payload = 0;
  std::size_t tail = 0;
  [[nodiscard]] std::size_t whole() const { return head + payload + tail; }
};
/// Longer than any head().
inline constexpr std::size_t kMostEnvelopeHead = 24;

/// The message that begins with these bytes; nullopt: more of them are needed.
[[nodiscard]] std::optional<Envelope> envelope(Transport way, std::span<const std::uint8_t> bytes);
/// A message that publishes a payload, or one of our viewers to its server.
[[nodiscard]] std::vector<std::uint8_t> published(Transport way,
                                                  std::span<const std::uint8_t> payload);

/// Introduces a fresh connection to a broker, or opens a WebSocket; who subscribes gets every frame
/// from then on. Waits for the answer; throws std::runtime_error where that is wrong.
void greet(Transport way, int socket, bool subscribe);

/// A TCP connection to a port of this machine; -1 where nobody listens there.
[[nodiscard]] int findConnected(std::uint16_t port);
/// Sends all of it; waits only where the peer's buffers are full.
void sendAll(int socket, std::span<const std::uint8_t> bytes);
/// Throws std::runtime_error with the reason of the last system call.
void require(bool done, const char* what);

}  // namespace hapticast::testing
