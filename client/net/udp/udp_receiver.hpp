// SPDX-License-Identifier: MIT
// Reception of frames by datagrams, beside a TCP session. Echoes the token to the server, passes
// authentic fragments to the receiver, and selects the transport.
// Thread: network.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/net/receiver.hpp"
#include "client/net/udp/loss_estimator.hpp"
#include "client/net/udp/transport_selector.hpp"
#include "client/net/udp/udp_socket.hpp"
#include "common/endpoint.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

/// UDP side of one session.
class UdpReceiver : public std::enable_shared_from_this<UdpReceiver> {
 public:
  struct Events {
    std::function<void(const Delivery&)> order;          ///< request to the server
    std::function<void(const std::string&)> on_message;  ///< message for the user, one line
  };
  /// Opens the UDP side of a session. Returns null if the server or the settings allow TCP only.
  /// `server` is the address of the TCP connection. `clock` and `receiver` must outlive the work on
  /// `io`.
  static std::shared_ptr<UdpReceiver> open(asio::io_context& io, const Clock& clock,
                                           Receiver& receiver, const DeliverySettings& settings,
                                           const Welcome& welcome, const Endpoint& server,
                                           Events events);

  /// Registers a frame that arrived over TCP.
  void tcpFrame(std::uint64_t id);
  /// Ends the work on `io`. No events follow.
  void close();
  [[nodiscard]] DatagramCounts counts() const;
  [[nodiscard]] std::uint64_t bytesReceived() const;
  [[nodiscard]] DeliveryStats state() const;

 private:
  UdpReceiver(asio::io_context& io, const Clock& clock, Receiver& receiver,
              const DeliverySettings& settings, const Welcome& welcome, const Endpoint& server,
              Events events);
  void start();
  asio::awaitable<void> startTimer();
  void update(LocalTime now);
  /// Returns a message about a flood of unauthentic datagrams; null if there is none.
  [[nodiscard]] const char* flood(LocalTime now);
  /// Opens and closes sockets until they match the selection.
  void applySelection(LocalTime now);
  void onDatagram(Transport transport, const Datagram& datagram, LocalTime now);

  asio::io_context& io_;
  const Clock& clock_;
  Receiver& receiver_;
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
  std::uint64_t bytes_ = 0;
  bool closed_ = false;
};

}  // namespace hapticast::client
