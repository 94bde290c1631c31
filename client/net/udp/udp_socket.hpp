// SPDX-License-Identifier: MIT
// UDP socket that receives the datagrams of a stream. It is connected to the server, or it is a
// member of a multicast group. If it is connected, the system drops datagrams of other senders.
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
#include "client/net/udp/datagram_key_ring.hpp"
#include "common/endpoint.hpp"
#include "common/result.hpp"
#include "common/time.hpp"
#include "common/transport/asio.hpp"
#include "common/transport/datagram.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::client {

/// Number of datagrams by the result of their verification.
struct DatagramCounts {
  std::uint64_t received = 0;     ///< datagrams that are new, authentic and readable
  std::uint64_t repeated = 0;     ///< duplicates of datagrams that have arrived already
  std::uint64_t foreign = 0;      ///< another token or stream, or a datagram of another protocol
  std::uint64_t astray = 0;       ///< the id of the frame is too far from the present frames
  std::uint64_t forged = 0;       ///< the signature is invalid
  std::uint64_t over_budget = 0;  ///< not verified, because the token bucket was empty
  /// Datagrams that could not be opened: the client does not have the key, the authentication tag
  /// is wrong, or the seal is missing in a sealed stream.
  std::uint64_t not_opened = 0;

  DatagramCounts operator+(const DatagramCounts& other) const;
};

/// Verifies the datagrams that arrive at one socket. Cheap checks are first (token, stream,
/// duplicate, key), then the signature, and last the seal. A token bucket limits the number of
/// signature verifications per second, so that a flood of datagrams costs a bounded computing time.
/// Times are arguments. The code opens no sockets. Thread: network.
class DatagramVerifier {
 public:
  /// Rate and size of the token bucket. The values are a choice: 240 frames/s of eight datagrams.
  /// The time was measured: a verification needs 100 us, so the bucket allows a fifth of a core.
  static constexpr double kVerifications_Hz = 2000.0;
  static constexpr double kBurst = 400.0;

  /// `token` is the token of the session or of the multicast group. `stream` and `key` are from the
  /// server's welcome. `keys` opens sealed datagrams and must outlive this object.
  DatagramVerifier(std::uint64_t token, std::uint32_t stream, VerifyingKey key,
                   DatagramKeyRing& keys);

  using IsWanted = std::function<FrameAssembler::Want(const DatagramHeader&)>;
  /// Returns the datagram in `bytes` if the server has signed it and it is new. Otherwise returns
  /// nullopt and counts the reason. The function calls `want` to classify a fragment, for example
  /// as a duplicate. A probe always counts as new. The payload is valid until the next call.
  std::optional<Datagram> verify(std::span<const std::uint8_t> bytes, LocalTime now,
                                 const IsWanted& want);

  [[nodiscard]] const DatagramCounts& counts() const { return counts_; }

 private:
  bool mayVerify(LocalTime now);

  std::uint64_t token_;
  std::uint32_t stream_;
  VerifyingKey key_;
  DatagramKeyRing* keys_;
  double budget_ = kBurst;
  std::optional<LocalTime> budget_at_;
  DatagramCounts counts_;
};

/// A socket that passes verified datagrams on.
class UdpSocket : public std::enable_shared_from_this<UdpSocket> {
 public:
  using OnDatagram = std::function<void(const Datagram&, LocalTime)>;
  using IsWanted = DatagramVerifier::IsWanted;

  /// Opens a socket that is connected to `server`. The host of `server` must be an address, not a
  /// name. An error is one line for the user.
  static Result<std::shared_ptr<UdpSocket>> toServer(asio::io_context& io, const Clock& clock,
                                                     const Endpoint& server,
                                                     DatagramVerifier verifier);
  /// Opens a socket that joins the multicast group `group`. `interface` is the name or address of a
  /// network interface. If it is empty, the interface is that of the route to `server`. An error is
  /// one line for the user.
  static Result<std::shared_ptr<UdpSocket>> ofGroup(asio::io_context& io, const Clock& clock,
                                                    const Endpoint& group,
                                                    const std::string& interface,
                                                    const Endpoint& server,
                                                    DatagramVerifier verifier);

  /// Starts to receive. Until close() it calls `is_wanted` for the header of each fragment, and
  /// `on_datagram` for each verified datagram.
  void start(IsWanted is_wanted, OnDatagram on_datagram);
  void close();
  /// Sends `bytes` to the server. It does not retry after an error.
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
