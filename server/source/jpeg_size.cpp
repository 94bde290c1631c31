// SPDX-License-Identifier: MIT
#include "server/source/jpeg_size.hpp"

#include <cstddef>

namespace hapticast::server {

std::optional<PictureSize> jpegSize(std::span<const std::uint8_t> jpeg) {
  const auto word = [&](std::size_t at) -> std::uint32_t {
    return (std::uint32_t{jpeg[at]} << 8U) | jpeg[at + 1];
  };
  if (jpeg.size() < 4 || word(0) != 0xFFD8) return std::nullopt;
  // Segments: FF, marker, big-endian length (which counts itself), content.
  std::size_t at = 2;
  while (at + 4 <= jpeg.size() && jpeg[at] == 0xFF) {
    const std::uint8_t marker = jpeg[at + 1];
    if (marker == 0xFF) {  // a fill byte
      ++at;
      continue;
    }
    const std::uint32_t length = word(at + 2);
    if (length < 2) return std::nullopt;
    // SOF0..SOF15 without DHT, JPG and DAC.
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) {
      if (length < 8 || at + 9 > jpeg.size()) return std::nullopt;
      return PictureSize{word(at + 7), word(at + 5)};
    }
    at += 2 + std::size_t{length};
  }
  return std::nullopt;
}

}  // namespace hapticast::server
