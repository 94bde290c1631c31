// SPDX-License-Identifier: MIT
#include "common/recording/mcap_chunk.hpp"

#include <string_view>

#include "common/recording/mcap_compression.hpp"
#include "common/recording/mcap_records.hpp"
#include "common/text.hpp"

namespace hapticast {

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
  return chunk;
}

}  // namespace hapticast
