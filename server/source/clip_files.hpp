// SPDX-License-Identifier: MIT
// What a folder holds: finds the colour, depth and mask files of an image sequence and what is
// declared about them, in one of three layouts. Opens no image. Thread: any.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

struct FrameFiles {
  std::filesystem::path color;
  std::filesystem::path depth;
  std::filesystem::path mask;  ///< empty: none
};

struct ClipFiles {
  std::vector<FrameFiles> frames;  ///< in order of time, at least one
  bool key_masks = false;          ///< only some frames have a mask
  double fps = 25.0;
  std::optional<int> declared_depth_bits;  ///< 8 or 16
  double mm_per_unit = 1.0;                ///< of 16-bit depth
  std::optional<CameraModel> camera;
  std::optional<double> fov_deg;  ///< how wide the picture is, where only that is known
};

/// Layouts:
/// * TUM RGB-D: rgb.txt and depth.txt with lines "timestamp file", each colour frame with the
/// nearest depth
///   frame within 20 ms (used once); 5000 units per metre, a Kinect's field of view.
/// * otherwise rgb/ or color/ and depth/, each with the same number of PNG or JPEG files, paired in
///   order of their names (numbers in names by value); perhaps mask/, with as many, or with fewer,
///   which are key masks and belong to the colour images of the same name.
/// A meta.json may say more; see clip_meta.hpp. Throws SourceError.
[[nodiscard]] ClipFiles findClipFiles(const std::filesystem::path& folder);

/// Order of file names in which runs of digits count by value: frame2 < frame10.
[[nodiscard]] bool naturalLess(const std::string& a, const std::string& b);

}  // namespace hapticast::server
