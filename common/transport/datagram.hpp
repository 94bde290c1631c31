// SPDX-License-Identifier: MIT
// Format of the datagrams (proto/datagrams.md). A datagram is the receiver's token and a body. The
// server seals (if it has TLS) and signs the body once for all receivers. An echo is a datagram
// from a viewer: it returns the token, and so registers the viewer's address. The functions are
// pure. Thread: any.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/time.hpp"
#include "common/transport/seal.hpp"
#include "common/transport/signature.hpp"

namespace hapticast {

/// Largest UDP payload. With the headers of UDP and IPv6 it has 1280 bytes, the smallest MTU of
/// IPv6.
inline constexpr std::size_t kMostDatagramBytes = 1232;
inline constexpr std::size_t kTokenBytes = 8;
inline constexpr std::size_t kDatagramHeaderBytes = 37;  ///< includes the token
inline constexpr std::uint8_t kPlainKeyId = 0;  ///< key id of a datagram that is not sealed
inline constexpr std::size_t kMostPieceBytes =
    kMostDatagramBytes - kDatagramHeaderBytes - kSealBytes - kSignatureBytes;
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
  std::uint16_t part = 0;   ///< number of this fragment, below `parts`
  std::uint16_t parts = 0;  ///< number of fragments of the frame; 0: the datagram is a probe

  [[nodiscard]] bool probe() const { return parts == 0; }
  bool operator==(const DatagramHeader&) const = default;
};

/// A parsed datagram. Its spans point into the bytes that were read.
struct Datagram {
  std::uint64_t token = 0;
  DatagramHeader header;
  std::uint8_t key_id = kPlainKeyId;  ///< number of the key that seals the payload
  std::uint64_t counter = 0;          ///< of a sealed datagram: never used twice with one key
  /// Of a sealed datagram: the bytes that its tag protects but does not encrypt.
  std::span<const std::uint8_t> readable;
  std::span<const std::uint8_t> sealed;   ///< encrypted payload and tag
  std::span<const std::uint8_t> payload;  ///< the fragment of a frame; empty while it is sealed
  std::span<const std::uint8_t> signed_bytes;
  std::span<const std::uint8_t> signature;  ///< signature of signed_bytes, not verified yet
};

/// Returns the datagram in `bytes`. Returns nullopt if its size or its numbers are invalid. It does
/// not verify the signature.
[[nodiscard]] std::optional<Datagram> readDatagram(std::span<const std::uint8_t> bytes) noexcept;

/// Returns the bytes that follow the token: header, payload and signature. If `seal` is not null,
/// it seals the payload. Requires a payload of at most kMostPieceBytes.
[[nodiscard]] std::vector<std::uint8_t> signedBody(const DatagramHeader& header,
                                                   std::span<const std::uint8_t> payload,
                                                   SigningKey& key, SealingKey* seal = nullptr);
/// Returns the bytes of a probe that follow the token. A probe is never sealed, because it has no
/// content. It has the size of the largest datagram, with the bytes of a seal. So if a probe
/// arrives, datagrams of every size can arrive.
[[nodiscard]] std::vector<std::uint8_t> probeBody(std::uint32_t stream, SigningKey& key);
/// Returns the token in the byte order of the wire.
[[nodiscard]] TokenBytes tokenBytes(std::uint64_t token) noexcept;

/// An echo: it registers a viewer's address at the server.
struct Echo {
  std::uint64_t token = 0;
  std::uint32_t stream = 0;
  bool operator==(const Echo&) const = default;
};
/// Returns the bytes of an echo.
[[nodiscard]] EchoBytes echoBytes(const Echo& echo) noexcept;
/// Returns the echo in `bytes`. Returns nullopt for other bytes.
[[nodiscard]] std::optional<Echo> readEcho(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace hapticast
