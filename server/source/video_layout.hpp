// SPDX-License-Identifier: MIT
// Layout of a video with depth: the place of the depth and its code. Thread: any.
#pragma once

#include <cstdint>

namespace hapticast::server {

/// Place of colour and depth in a video.
enum class Layout : std::uint8_t {
  kSeparate,    ///< tracks or files of their own
  kSideBySide,  ///< left and right half of one picture
  kTopBottom,   ///< upper and lower half of one picture
};

/// Code of depth in a video of 8 bits.
enum class DepthCode : std::uint8_t {
  kGrey,     ///< near is white
  kInverse,  ///< grey, near is dark
  kHue,      ///< mm = 3000 * hue (HSV, 0..1), as Record3D writes it; 100..2800 mm are valid
};

/// Values of the flags --layout and --depth-code.
struct VideoLayout {
  Layout layout = Layout::kSeparate;
  DepthCode code = DepthCode::kGrey;
  bool operator==(const VideoLayout&) const = default;
};

}  // namespace hapticast::server
