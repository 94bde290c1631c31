// SPDX-License-Identifier: MIT
// Datagram format (proto/README.md): the receiver's token, then a body that is signed once for all
// receivers. The echo, with which a viewer registers its address. Pure functions on bytes. Thread:
// any.
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

/// Limit of the UDP payload: with the headers of UDP and IPv6 it is IPv6's least MTU of 1280 bytes.
inline constexpr std::size_t kMostDatagramBytes = 1232;
inline constexpr std::size_t kTokenBytes = 8;
inline constexpr std::size_t kDatagramHeaderBytes = 36;  ///< token included
inline constexpr std::size_t kMostPieceBytes =
    kMostDatagramBytes - kDatagramHeaderBytes - kSignatureBytes;
inline constexpr std::size_t kMostParts = 65'535;
inline constexpr std::size_t kEchoBytes = 12;

using TokenBytes = std::array<std::uint8_t, kTokenBytes>;
using EchoBytes = std::array<std::uint8_t, kEchoBytes>;

/// Header of the signed body.
struct DatagramHeader {
  std::uint32_t stream = 0;  ///< number of this run of the server
  std::uint32_t epoch = 0;
  std::uint64_t frame = 0;
  MediaTime media_time;
  std::uint16_t part = 0;   ///< below `parts`
  std::uint16_t parts = 0;  ///< of the frame, 0: a probe

  [[nodiscard]] bool probe() const { return parts == 0; }
  bool operator==(const DatagramHeader&) const = default;
};

/// A parsed datagram; its spans point into the bytes read.
struct Datagram {
  std::uint64_t token = 0;
  DatagramHeader header;
  std::span<const std::uint8_t> payload;  ///< fragment
  std::span<const std::uint8_t> signed_bytes;
  std::span<const std::uint8_t> signature;  ///< of signed_bytes, not verified yet
};

/// Parses a datagram; nullopt if size or numbers are invalid. Cheap: it does not verify the
/// signature.
[[nodiscard]] std::optional<Datagram> readDatagram(std::span<const std::uint8_t> bytes) noexcept;

/// Returns the bytes after the token, with signature. Requires a payload of at most
/// kMostPieceBytes.
[[nodiscard]] std::vector<std::uint8_t> signedBody(const DatagramHeader& header,
                                                   std::span<const std::uint8_t> payload,
                                                   SigningKey& key);
/// Returns the body of a probe, of full size: if it arrives, every datagram can arrive.
[[nodiscard]] std::vector<std::uint8_t> probeBody(std::uint32_t stream, SigningKey& key);
/// Returns the token in the byte order of the wire.
[[nodiscard]] TokenBytes tokenBytes(std::uint64_t token) noexcept;

/// Registration of a viewer's address.
struct Echo {
  std::uint64_t token = 0;
  std::uint32_t stream = 0;
  bool operator==(const Echo&) const = default;
};
/// Returns the bytes of an echo.
[[nodiscard]] EchoBytes echoBytes(const Echo& echo) noexcept;
/// Parses an echo; nullopt for other bytes.
[[nodiscard]] std::optional<Echo> readEcho(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace hapticast
