// SPDX-License-Identifier: MIT
// Checksum and decompression of MCAP files by zlib, zstd and lz4. A source of its own, because a
// web page has none of these libraries (client/web). Thread: any.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace hapticast {

/// Returns the CRC-32 of `bytes`, which follow bytes with the CRC-32 `before`.
[[nodiscard]] std::uint32_t computeCrc32(std::span<const std::uint8_t> bytes,
                                         std::uint32_t before = 0);

/// Returns whether decompress() knows `compression`.
[[nodiscard]] bool canDecompress(std::string_view compression);
/// Fills `out` with the decompressed bytes of `in`. Returns whether they are exactly as many.
/// Requires canDecompress().
[[nodiscard]] bool decompress(std::string_view compression, std::span<const std::uint8_t> in,
                              std::span<std::uint8_t> out);

}  // namespace hapticast
