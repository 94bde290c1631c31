// SPDX-License-Identifier: MIT
// Authentication of datagrams: first cheap checks (token, stream, duplicate), then the signature. A
// token bucket limits the verifications per second, so that a flood costs bounded time. Times are
// arguments; no sockets.
// Thread: network.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "client/net/frame_assembler.hpp"
#include "common/time.hpp"
#include "common/transport/datagram.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::client {

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

}  // namespace hapticast::client
