// SPDX-License-Identifier: MIT
// Layout of a source with depth: the files and the place of the depth, its code and unit.
// Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

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

/// Values of the flags --layout, --depth-code, --depth-unit, --color, --depth and --topics, and
/// whether --depth-from adds the depth.
struct VideoLayout {
  Layout layout = Layout::kSeparate;
  DepthCode code = DepthCode::kGrey;
  /// mm of one unit of depth. nullopt: as the source states, else 1 for integers, 1000 for floats.
  std::optional<double> depth_unit_mm = std::nullopt;
  /// Patterns of the images in a folder, relative to it. Empty: the server recognises the layout.
  std::string color_glob = "";
  std::string depth_glob = "";
  /// Topics in a recording: "COLOR,DEPTH". Empty: the only ones.
  std::string topics = "";
  /// True: the source delivers colour only (RgbdFrame::depth is empty), and needs no depth.
  bool color_only = false;
  bool operator==(const VideoLayout&) const = default;
};

}  // namespace hapticast::server
