// SPDX-License-Identifier: MIT
#include "common/recording/mcap_chunk.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <memory>
#include <string_view>

#include "common/recording/mcap_records.hpp"
#include "common/text.hpp"

namespace hapticast {

namespace {

/// Fills `out` with the decompressed bytes of `in`. Returns whether they are exactly as many.
bool decompressZstd(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  return ZSTD_decompress(out.data(), out.size(), in.data(), in.size()) == out.size();
}

bool decompressLz4(std::span<const std::uint8_t> in, std::span<std::uint8_t> out) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) return false;
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      made, &LZ4F_freeDecompressionContext);
  while (true) {
    std::size_t written = out.size();
    std::size_t used = in.size();
    const std::size_t more =
        LZ4F_decompress(context.get(), out.data(), &written, in.data(), &used, nullptr);
    if (LZ4F_isError(more) != 0) return false;
    out = out.subspan(written);
    in = in.subspan(used);
    if (more == 0) return out.empty();
    if (written == 0 && used == 0) return false;  // input or space is missing
  }
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
  } else if (compression == "zstd" || compression == "lz4") {
    chunk.records.resize(static_cast<std::size_t>(size));
    const auto decompress = compression == "zstd" ? decompressZstd : decompressLz4;
    if (!decompress(bytes, chunk.records)) return {{}, "has a damaged chunk"};
  } else {
    return {{}, "has the unknown compression " + quote(compression)};
  }
  if (crc != 0 && computeCrc32(chunk.records) != crc) return {{}, "has a wrong checksum"};
  return chunk;
}

}  // namespace hapticast
