// SPDX-License-Identifier: MIT
// Headers of the picture formats that OpenCV decodes: PNG, JPEG, WebP, BMP, TIFF, OpenEXR, PGM and
// PPM. Functions read the size of a picture from its header before a decoder allocates memory.
// Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace hapticast::server {

/// Size of a picture. It is read from the header of the file, before a decoder allocates memory.
/// Thread: any.
struct PictureSize {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  bool operator==(const PictureSize&) const = default;
};

/// Facts in the header of a picture file. Thread: any.
struct PictureHeader {
  PictureSize size;
  /// A phrase about a file that has this header but cannot be decoded ("is cut off"); "": none.
  std::string problem;
};

/// Returns the size of a JPEG picture from its frame header (ITU T.81 annex B), without decoding.
/// Returns nullopt if there is no such header.
[[nodiscard]] std::optional<PictureSize> jpegSize(std::span<const std::uint8_t> jpeg);

/// Returns the header of a file in one of these formats, without decoding. Returns nullopt for
/// other bytes, and for a header that is not complete.
[[nodiscard]] std::optional<PictureHeader> readPictureHeader(std::span<const std::uint8_t> bytes);

}  // namespace hapticast::server
