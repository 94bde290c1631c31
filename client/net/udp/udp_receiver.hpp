// SPDX-License-Identifier: MIT
// Frames by datagrams beside a conversation over TCP: echoes the token, hands what is the server's
// to the receiver, and decides which way frames shall come. Thread: network.
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

class UdpReceiver : public std::enable_shared_from_this<UdpReceiver> {
 public:
  struct Events {
    std::function<void(const Delivery&)> order;          ///< the server is to be told
    std::function<void(const std::string&)> on_message;  ///< a person is to be told
  };
  /// `server`: the address that the TCP connection leads to. Null where the server offers no way
  /// but TCP, or none is wanted. `clock` and `receiver` outlive the work on `io`.
  static std::shared_ptr<UdpReceiver> open(asio::io_context& io, const Clock& clock,
                                           Receiver& receiver, const DeliverySettings& settings,
                                           const Welcome& welcome, const Endpoint& server,
                                           Events events);

  /// A frame has come over TCP.
  void tcpFrame(std::uint64_t id);
  /// Ends its work on `io` and tells nobody any more.
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
  /// What a person is told of a flood of datagrams that are not the server's; null: there is none.
  [[nodiscard]] const char* flood(LocalTime now);
  /// Opens and closes paths as the choice asks for them.
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
  DatagramCounts counted_;  // of the path, by counted_at_
  LocalTime counted_at_{};
  DatagramCounts counts_;  // of paths that were closed
  std::uint64_t bytes_ = 0;
  bool closed_ = false;
};

}  // namespace hapticast::client
