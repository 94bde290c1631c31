// SPDX-License-Identifier: MIT
#include "common/recording/mcap_compression.hpp"

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <memory>

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

std::uint32_t computeCrc32(std::span<const std::uint8_t> bytes, std::uint32_t before) {
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

bool canDecompress(std::string_view compression) {
  return compression == "zstd" || compression == "lz4";
}

bool decompress(std::string_view compression, std::span<const std::uint8_t> in,
                std::span<std::uint8_t> out) {
  return compression == "zstd" ? decompressZstd(in, out) : decompressLz4(in, out);
}

}  // namespace hapticast
