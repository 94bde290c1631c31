// SPDX-License-Identifier: MIT
// Verification of Ed25519 signatures (RFC 8032, section 5.1.7) for a web page. Browsers have
// Ed25519 only in pages over https, and a page over plain http in a LAN verifies, too. It only
// verifies: it has no secrets, so its run time may depend on the data. It accepts exactly the
// signatures that OpenSSL accepts, which tests compare. Thread: any.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace hapticast::client::ed25519 {

/// A number modulo p = 2^255 - 19: nine limbs of 29 bits, least significant first.
using Field = std::array<std::uint64_t, 9>;

/// A point of the curve in extended coordinates: x = X/Z, y = Y/Z, x*y = T/Z.
struct Point {
  Field x, y, z, t;
};

/// Returns the point that the 32 bytes encode, or nullopt if they encode none.
[[nodiscard]] std::optional<Point> decodePoint(std::span<const std::uint8_t, 32> bytes);

/// Returns whether `signature` is the signature of `bytes` by the owner of the key `key`, whose
/// decoded point is `point`.
[[nodiscard]] bool verify(std::span<const std::uint8_t> bytes,
                          std::span<const std::uint8_t, 64> signature,
                          std::span<const std::uint8_t, 32> key, const Point& point);

}  // namespace hapticast::client::ed25519
