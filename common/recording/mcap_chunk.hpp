// SPDX-License-Identifier: MIT
// Chunks of MCAP files (mcap_records.hpp): decompression, limits and CRC. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hapticast {

/// Largest chunk, compressed or not, bytes. Other programs write chunks of some MiB; a single raw
/// picture of 8K needs 100 MiB.
inline constexpr std::uint64_t kMostChunkBytes = 256U << 20U;

/// Records of a chunk.
struct McapChunk {
  std::vector<std::uint8_t> records;
  std::string problem;  ///< a phrase such as "has a wrong checksum"; empty: none
};

/// Returns the records of the chunk whose record has the content `content`. The CRC is checked,
/// unless it is 0 (none). Compressions: none, "zstd" and "lz4". Limits hold before memory is
/// allocated. A chunk whose records are too many for its bytes in the file is refused.
[[nodiscard]] McapChunk readChunk(std::span<const std::uint8_t> content);

}  // namespace hapticast
