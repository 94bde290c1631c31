// SPDX-License-Identifier: MIT
// Reception of frames by datagrams, in addition to a TCP session. To register its UDP address at
// the server, the client sends echoes. An echo is a datagram that returns the token that the server
// sent over TCP. The class opens the socket of the transport that the TransportSelector selects,
// and passes authentic fragments to the Receiver.
// Thread: network.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/net/receiver.hpp"
#include "client/net/udp/datagram_key_ring.hpp"
#include "client/net/udp/loss_estimator.hpp"
#include "client/net/udp/transport_selector.hpp"
#include "client/net/udp/udp_socket.hpp"
#include "common/endpoint.hpp"
#include "common/protocol/messages.hpp"
#include "common/rate_limiter.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

/// The UDP side of one session with a server.
class UdpReceiver : public std::enable_shared_from_this<UdpReceiver> {
 public:
  struct Events {
    /// The client has to send this request to the server.
    std::function<void(const Delivery&)> order;
    std::function<void(const std::string&)> on_message;  ///< a message for the user, one line
  };
  /// Opens the UDP side of a session. Returns null if the server or the settings allow TCP only.
  /// `keys` opens sealed datagrams. `welcome` is the server's welcome, and `server` is the address
  /// of the TCP connection. `encrypted`: that connection has TLS. `clock`, `receiver` and `keys`
  /// must outlive the work on `io`.
  static std::shared_ptr<UdpReceiver> open(asio::io_context& io, const Clock& clock,
                                           Receiver& receiver, DatagramKeyRing& keys,
                                           const DeliverySettings& settings, const Welcome& welcome,
                                           const Endpoint& server, bool encrypted, Events events);

  /// Registers a frame that arrived over TCP.
  void tcpFrame(std::uint64_t id);
  /// Closes the sockets and ends the work on `io`. The object then calls no more events.
  void close();
  [[nodiscard]] DatagramCounts counts() const;
  [[nodiscard]] std::uint64_t bytesReceived() const;
  [[nodiscard]] DeliveryStats state() const;

 private:
  UdpReceiver(asio::io_context& io, const Clock& clock, Receiver& receiver, DatagramKeyRing& keys,
              const DeliverySettings& settings, const Welcome& welcome, const Endpoint& server,
              Events events);
  void start();
  asio::awaitable<void> startTimer();
  void update(LocalTime now);
  /// Returns the reason if too many unauthentic datagrams arrive, else null.
  [[nodiscard]] const char* flood(LocalTime now);
  /// Reports datagrams that could not be opened, at most once a minute.
  void reportUnopened(LocalTime now);
  /// Opens and closes sockets until they match the selected transport.
  void applySelection(LocalTime now);
  void onDatagram(Transport transport, const Datagram& datagram, LocalTime now);

  asio::io_context& io_;
  const Clock& clock_;
  Receiver& receiver_;
  DatagramKeyRing& keys_;
  DeliverySettings settings_;
  Welcome welcome_;
  Endpoint server_;
  Events events_;
  asio::steady_timer timer_;
  TransportSelector choice_;
  std::uint32_t copies_;
  LossEstimator meter_;
  std::optional<Transport> opened_;
  std::shared_ptr<UdpSocket> path_;
  std::optional<LocalTime> echoed_at_;
  DatagramCounts counted_;  // counters of path_ at counted_at_
  LocalTime counted_at_{};
  DatagramCounts counts_;  // of closed sockets
  std::uint64_t reported_unopened_ = 0;
  RateLimiter unopened_interval_ = RateLimiter::makeOnceAMinute();
  std::uint64_t bytes_ = 0;
  bool closed_ = false;
};

}  // namespace hapticast::client
