// SPDX-License-Identifier: MIT
// Decodes the picture of an image message (image_message.hpp). Sizes are checked before memory is
// allocated. Thread: any.
#pragma once

#include <cstdint>
#include <string>

#include "server/source/picture/image_file.hpp"
#include "server/source/recording/image_message.hpp"

namespace hapticast::server {

/// What the pictures of a topic show.
enum class ImageKind : std::uint8_t {
  kUnknown,
  kColor,
  kDepth,
};

/// Kind of a picture, or its problem as a phrase, with kUnknown.
struct KindResult {
  ImageKind kind = ImageKind::kUnknown;
  std::string problem;
};

/// Returns what the picture of `image` shows. Depth is 16UC1, mono16, 32FC1, compressedDepth, and a
/// compressed picture with one channel of 16 bits or of floats. Colour is rgb8, bgr8, rgba8, bgra8,
/// mono8, 8UC1, 8UC3 (BGR), and each other compressed picture.
[[nodiscard]] KindResult findKind(const ImageMessage& image);

/// Return the picture of `image`, or its problem as a phrase. readColor() returns BGR (CV_8UC3).
/// readDepth() returns CV_16UC1, or CV_32FC1; the caller converts it with toDepth(). Depth of the
/// format compressedDepth with 32FC1 has the depth in metres as A / (value - B); its A and B stand
/// in front of the picture, and the value 0 is not measured.
[[nodiscard]] ImageResult readColor(const ImageMessage& image);
[[nodiscard]] ImageResult readDepth(const ImageMessage& image);

}  // namespace hapticast::server
