// SPDX-License-Identifier: MIT
// UDP socket of a stream: connected to the server, so that the system drops datagrams of other
// senders, or a member of a multicast group.
// Thread: network.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "client/net/udp/datagram_verifier.hpp"
#include "common/endpoint.hpp"
#include "common/result.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

/// A socket with its verifier.
class UdpSocket : public std::enable_shared_from_this<UdpSocket> {
 public:
  using OnDatagram = std::function<void(const Datagram&, LocalTime)>;
  using IsWanted = DatagramVerifier::IsWanted;

  /// Opens a socket connected to `server`, an address without a name. Returns one line for the user
  /// on an error.
  static Result<std::shared_ptr<UdpSocket>> toServer(asio::io_context& io, const Clock& clock,
                                                     const Endpoint& server,
                                                     DatagramVerifier verifier);
  /// Joins a multicast group on `interface` (name or address; empty: that of the route to
  /// `server`). Returns one line for the user on an error.
  static Result<std::shared_ptr<UdpSocket>> ofGroup(asio::io_context& io, const Clock& clock,
                                                    const Endpoint& group,
                                                    const std::string& interface,
                                                    const Endpoint& server,
                                                    DatagramVerifier verifier);

  /// Starts reading. Calls `look` and `take` until close().
  void start(IsWanted is_wanted, OnDatagram on_datagram);
  void close();
  /// Sends `bytes` to the server without a retry.
  void send(std::span<const std::uint8_t> bytes);

  [[nodiscard]] const DatagramCounts& counts() const { return verifier_.counts(); }
  [[nodiscard]] std::uint64_t bytesReceived() const { return bytes_; }

 private:
  UdpSocket(asio::ip::udp::socket socket, const Clock& clock, DatagramVerifier verifier);
  asio::awaitable<void> readAll();
  /// Reads a bounded number of datagrams. Returns true if more may be available.
  bool readSome();

  asio::ip::udp::socket socket_;
  const Clock& clock_;
  DatagramVerifier verifier_;
  IsWanted is_wanted_;
  OnDatagram on_datagram_;
  std::uint64_t bytes_ = 0;
  // One byte more: detects oversized datagrams.
  std::array<std::uint8_t, kMostDatagramBytes + 1> buffer_{};
};

}  // namespace hapticast::client
