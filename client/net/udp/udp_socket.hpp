// SPDX-License-Identifier: MIT
// UDP socket of a stream: connected to the server, so that the system drops datagrams of other
// senders, or a member of a multicast group.
// Thread: network.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "client/net/frame_assembler.hpp"
#include "common/endpoint.hpp"
#include "common/result.hpp"
#include "common/time.hpp"
#include "common/transport/asio.hpp"
#include "common/transport/datagram.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::client {

// Authentication of datagrams: first cheap checks (token, stream, duplicate), then the signature. A
// token bucket limits the verifications per second, so that a flood costs bounded time. Times are
// arguments; no sockets.
// Thread: network.

/// Datagrams by the result of their verification.
struct DatagramCounts {
  std::uint64_t received = 0;     ///< valid signature, and new
  std::uint64_t repeated = 0;     ///< duplicates
  std::uint64_t foreign = 0;      ///< another token or stream, or no datagram of this protocol
  std::uint64_t astray = 0;       ///< frame id too far from the present frames
  std::uint64_t forged = 0;       ///< invalid signature
  std::uint64_t over_budget = 0;  ///< unverified: the token bucket was empty

  DatagramCounts operator+(const DatagramCounts& other) const;
};

/// Verifies the datagrams of one path.
class DatagramVerifier {
 public:
  /// Rate and size of the token bucket. Chosen: 240 frames/s of eight datagrams. Measured: 100 us
  /// each, a fifth of a core.
  static constexpr double kVerifications_Hz = 2000.0;
  static constexpr double kBurst = 400.0;

  /// `token` is that of the session or of the group; `stream` and `key` are those that the server
  /// announced.
  DatagramVerifier(std::uint64_t token, std::uint32_t stream, VerifyingKey key);

  using IsWanted = std::function<FrameAssembler::Want(const DatagramHeader&)>;
  /// Returns the datagram in `bytes` if the server has signed it and it is new; else nullopt.
  /// `want` classifies its fragment. A probe always counts as new.
  std::optional<Datagram> verify(std::span<const std::uint8_t> bytes, LocalTime now,
                                 const IsWanted& want);

  [[nodiscard]] const DatagramCounts& counts() const { return counts_; }

 private:
  bool mayVerify(LocalTime now);

  std::uint64_t token_;
  std::uint32_t stream_;
  VerifyingKey key_;
  double budget_ = kBurst;
  std::optional<LocalTime> budget_at_;
  DatagramCounts counts_;
};

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
