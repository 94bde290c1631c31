// SPDX-License-Identifier: MIT
// What is done with a datagram before it is believed: cheap looks first, then the signature, of
// which only so many are verified a second, so that a flood costs bounded time. Pure: times are
// arguments, no sockets. Thread: network.
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

/// By what became of them.
struct DatagramCounts {
  std::uint64_t received = 0;     ///< signed by the server, and new
  std::uint64_t repeated = 0;     ///< copies of what had come before
  std::uint64_t foreign = 0;      ///< of no token or stream of ours, or no datagram at all
  std::uint64_t astray = 0;       ///< frames too far from those that come
  std::uint64_t forged = 0;       ///< the signature is wrong
  std::uint64_t over_budget = 0;  ///< not looked at: too many signatures in this second

  DatagramCounts operator+(const DatagramCounts& other) const;
};

class DatagramVerifier {
 public:
  /// Chosen: 240 frames/s of eight datagrams; a fifth of a core on the machine it was measured on
  /// (some 100 us each).
  static constexpr double kVerifications_Hz = 2000.0;
  static constexpr double kBurst = 400.0;

  /// `token`: the session's or the group's; `stream` and `key` as the server announced them.
  DatagramVerifier(std::uint64_t token, std::uint32_t stream, VerifyingKey key);

  using IsWanted = std::function<FrameAssembler::Want(const DatagramHeader&)>;
  /// The datagram that the bytes are, where the server has sent it and it is new; `want` says what
  /// its frame still lacks. A probe is given every time.
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
