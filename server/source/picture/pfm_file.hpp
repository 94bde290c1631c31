// SPDX-License-Identifier: MIT
// Depth files in the format PFM: a greyscale picture of floats. Thread: any.
#pragma once

#include <cstdint>
#include <span>

#include "server/source/picture/image_result.hpp"

namespace hapticast::server {

/// Returns true if `bytes` begin like a PFM file.
[[nodiscard]] bool isPfm(std::span<const std::uint8_t> bytes);

/// Decodes a PFM file with grey values (magic "Pf") of either byte order. Its scale is ignored, as
/// other readers do. OpenCV's decoder divides by the scale, so depth of Middlebury's files would be
/// 255 times too large. The image is CV_32FC1. Returns the image, or the problem of the file as a
/// phrase. It checks the size before it allocates memory.
[[nodiscard]] ImageResult decodePfm(std::span<const std::uint8_t> bytes);

}  // namespace hapticast::server
