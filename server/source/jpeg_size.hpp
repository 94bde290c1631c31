// SPDX-License-Identifier: MIT
// JPEG header parser: reads the size of a picture before a decoder allocates memory for it. Thread:
// any.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace hapticast::server {

/// Size of a picture.
struct PictureSize {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  bool operator==(const PictureSize&) const = default;
};

/// Returns the size in the frame header (ITU T.81 annex B) without decoding; nullopt if there is
/// none.
[[nodiscard]] std::optional<PictureSize> jpegSize(std::span<const std::uint8_t> jpeg);

}  // namespace hapticast::server
