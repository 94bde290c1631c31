// SPDX-License-Identifier: MIT
// Depth files other than PNG and JPEG: TIFF, OpenEXR, PGM, and NumPy's NPY. Functions read the size
// of a picture from its header before a decoder allocates memory. They describe a problem by a
// phrase that follows the file's name in a message. Thread: any.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "server/source/picture/image_file.hpp"

namespace hapticast::server {

/// Returns the size of a picture from the header of one of these formats, without decoding. Returns
/// nullopt for other bytes, and for a header that is not complete.
[[nodiscard]] std::optional<PictureSize> depthFileSize(std::span<const std::uint8_t> bytes);

/// Returns true if `bytes` begin like an NPY file.
[[nodiscard]] bool isNpy(std::span<const std::uint8_t> bytes);

/// Decodes an NPY file (version 1 to 3) with a matrix in the order of C: |u1, <u2, <f4 or <f8. The
/// image has 8 or 16 bits, or is CV_32FC1. Returns the image, or the problem of the file. Requires
/// isNpy().
[[nodiscard]] ImageResult decodeNpy(std::span<const std::uint8_t> bytes);

}  // namespace hapticast::server
