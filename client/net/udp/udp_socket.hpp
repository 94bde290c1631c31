// SPDX-License-Identifier: MIT
// A socket that datagrams of a stream come in on: connected to the server, so that the system drops
// what others send, or a member of a group. Thread: network.
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

class UdpSocket : public std::enable_shared_from_this<UdpSocket> {
 public:
  using OnDatagram = std::function<void(const Datagram&, LocalTime)>;
  using IsWanted = DatagramVerifier::IsWanted;

  /// `server`: an address, no name. An error is one line for a person.
  static Result<std::shared_ptr<UdpSocket>> toServer(asio::io_context& io, const Clock& clock,
                                                     const Endpoint& server,
                                                     DatagramVerifier verifier);
  /// Joins a group on an interface, by name or address; empty: the one that leads to `server`.
  static Result<std::shared_ptr<UdpSocket>> ofGroup(asio::io_context& io, const Clock& clock,
                                                    const Endpoint& group,
                                                    const std::string& interface,
                                                    const Endpoint& server,
                                                    DatagramVerifier verifier);

  /// Begins to read; `is_wanted` and `on_datagram` are called until close().
  void start(IsWanted is_wanted, OnDatagram on_datagram);
  void close();
  /// To the server, as it is; what is lost is lost.
  void send(std::span<const std::uint8_t> bytes);

  [[nodiscard]] const DatagramCounts& counts() const { return verifier_.counts(); }
  [[nodiscard]] std::uint64_t bytesReceived() const { return bytes_; }

 private:
  UdpSocket(asio::ip::udp::socket socket, const Clock& clock, DatagramVerifier verifier);
  asio::awaitable<void> readAll();
  /// Reads what is there, a bounded number; true where there may be more.
  bool readSome();

  asio::ip::udp::socket socket_;
  const Clock& clock_;
  DatagramVerifier verifier_;
  IsWanted is_wanted_;
  OnDatagram on_datagram_;
  std::uint64_t bytes_ = 0;
  std::array<std::uint8_t, kMostDatagramBytes + 1> buffer_{};  // a longer one is seen to be
};

}  // namespace hapticast::client
