// SPDX-License-Identifier: MIT
// File discovery for an image sequence: finds colour, depth and mask files and their declarations,
// in one of three layouts. Opens no image. Thread: any.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// Files of one frame.
struct FrameFiles {
  std::filesystem::path color;
  std::filesystem::path depth;
  std::filesystem::path mask;  ///< empty: none
};

/// Files of a clip with their declarations.
struct ClipFiles {
  std::vector<FrameFiles> frames;          ///< in order of time, at least one
  bool key_masks = false;                  ///< only some frames have a mask
  double fps = 25.0;                       ///< frames/s
  std::optional<int> declared_depth_bits;  ///< 8 or 16
  double mm_per_unit = 1.0;                ///< scale of 16-bit depth
  std::optional<CameraModel> camera;
  std::optional<double> fov_deg;  ///< horizontal field of view, if no camera is declared
};

/// Finds the files of a clip in `folder`. Throws SourceError. A meta.json may declare more; see
/// clip_meta.hpp. Layouts:
/// * TUM RGB-D: rgb.txt and depth.txt with lines "timestamp file". Each colour frame pairs with the
///   nearest depth frame within 20 ms (used once). 5000 units per metre, a Kinect's field of view.
/// * Otherwise rgb/ or color/ and depth/, each with the same number of PNG or JPEG files, paired in
///   order of their names (numbers in names by value). An optional mask/ has as many files, or
///   fewer: key masks for the colour images of the same name.
[[nodiscard]] ClipFiles findClipFiles(const std::filesystem::path& folder);

/// Returns whether `a` sorts before `b`, with runs of digits compared by value: frame2 < frame10.
[[nodiscard]] bool naturalLess(const std::string& a, const std::string& b);

}  // namespace hapticast::server
