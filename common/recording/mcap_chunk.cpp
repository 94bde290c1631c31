// SPDX-License-Identifier: MIT
#include "common/recording/mcap_chunk.hpp"

#include <string_view>

#include "common/recording/mcap_compression.hpp"
#include "common/recording/mcap_records.hpp"
#include "common/text.hpp"

namespace hapticast {

namespace {

// Most records of a chunk: empty ones compress to a ten thousandth, so 24 kB could have 30 million.
// Messages with times that rise need 2.8 bytes each (zstd, level 19). Equal messages of a
// simulation that pauses need none; the smallest ones (31 bytes) fill 4 MiB, the largest chunk that
// other programs write if they are not asked.
constexpr std::size_t kRecordsPerByte = 4;
constexpr std::size_t kEqualRecords = (4U << 20U) / 31;

/// Returns whether `records` are at most as many as a chunk of `bytes` bytes in the file may have.
bool areFewEnough(std::span<const std::uint8_t> records, std::size_t bytes) {
  std::size_t left = kEqualRecords + kRecordsPerByte * bytes;
  for (McapIn in(records); readRecord(in); --left)
    if (left == 0) return false;
  return true;
}

}  // namespace

McapChunk readChunk(std::span<const std::uint8_t> content) {
  McapIn in(content);
  (void)in.take(16);  // times of the first and the last message: each message has its own
  const auto size = in.number<std::uint64_t>();
  const auto crc = in.number<std::uint32_t>();
  const std::string_view compression = in.text();
  const auto bytes = in.take(in.number<std::uint64_t>());
  if (!in.ok()) return {{}, "has a damaged chunk"};
  if (size > kMostChunkBytes) return {{}, "has a chunk of more than 256 MiB"};
  McapChunk chunk;
  if (compression.empty()) {
    if (bytes.size() != size) return {{}, "has a damaged chunk"};
    chunk.records.assign(bytes.begin(), bytes.end());
  } else if (canDecompress(compression)) {
    chunk.records.resize(static_cast<std::size_t>(size));
    if (!decompress(compression, bytes, chunk.records)) return {{}, "has a damaged chunk"};
  } else {
    return {{}, "has the unknown compression " + quote(compression)};
  }
  if (crc != 0 && computeCrc32(chunk.records) != crc) return {{}, "has a wrong checksum"};
  if (!areFewEnough(chunk.records, bytes.size())) return {{}, "has a chunk of too many records"};
  return chunk;
}

}  // namespace hapticast
