// SPDX-License-Identifier: MIT
// One datagram, byte by byte (proto/README.md): a token that says whose it is, then a body that is
// signed once for all who get it. And the echo, by which a viewer says where it wants them. Pure
// functions on bytes. Thread: any.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/time.hpp"
#include "common/transport/signature.hpp"

namespace hapticast {

/// Of UDP payload: with the headers of UDP and IPv6 it is IPv6's least MTU of 1280 bytes.
inline constexpr std::size_t kMostDatagramBytes = 1232;
inline constexpr std::size_t kTokenBytes = 8;
inline constexpr std::size_t kDatagramHeaderBytes = 36;  ///< token included
inline constexpr std::size_t kMostPieceBytes =
    kMostDatagramBytes - kDatagramHeaderBytes - kSignatureBytes;
inline constexpr std::size_t kMostParts = 65'535;
inline constexpr std::size_t kEchoBytes = 12;

using TokenBytes = std::array<std::uint8_t, kTokenBytes>;
using EchoBytes = std::array<std::uint8_t, kEchoBytes>;

/// What the signed body says before its payload.
struct DatagramHeader {
  std::uint32_t stream = 0;  ///< of this run of the server
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;
  MediaTime media_time;
  std::uint16_t part = 0;   ///< below `parts`
  std::uint16_t parts = 0;  ///< of the frame; 0: a probe

  [[nodiscard]] bool probe() const { return parts == 0; }
  bool operator==(const DatagramHeader&) const = default;
};

struct Datagram {
  std::uint64_t token = 0;
  DatagramHeader header;
  std::span<const std::uint8_t> payload;  ///< of the bytes that were read
  std::span<const std::uint8_t> signed_bytes;
  std::span<const std::uint8_t> signature;  ///< of those, not verified yet
};

/// What stands in the bytes, nullopt where their size or numbers cannot be a datagram's. Cheap: the
/// signature is the caller's to verify.
[[nodiscard]] std::optional<Datagram> readDatagram(std::span<const std::uint8_t> bytes) noexcept;

/// The bytes behind the token, signature included. Requires at most kMostPieceBytes.
[[nodiscard]] std::vector<std::uint8_t> signedBody(const DatagramHeader& header,
                                                   std::span<const std::uint8_t> payload,
                                                   SigningKey& key);
/// The body of a probe, of full size: where it arrives, every datagram does.
[[nodiscard]] std::vector<std::uint8_t> probeBody(std::uint32_t stream, SigningKey& key);
[[nodiscard]] TokenBytes tokenBytes(std::uint64_t token) noexcept;

struct Echo {
  std::uint64_t token = 0;
  std::uint32_t stream = 0;
  bool operator==(const Echo&) const = default;
};
[[nodiscard]] EchoBytes echoBytes(const Echo& echo) noexcept;
/// nullopt where the bytes are not an echo's.
[[nodiscard]] std::optional<Echo> readEcho(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace hapticast
