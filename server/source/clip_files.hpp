// SPDX-License-Identifier: MIT
// File discovery for an image sequence: finds colour, depth and mask files and their declarations,
// in one of three layouts. Opens no image. Thread: any.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

// Parser of meta.json, the author's declarations about a clip. Thread: any.

/// Declarations; nullopt: not declared.
struct ClipMeta {
  std::optional<double> fps;          ///< "fps", 1..240
  std::optional<double> mm_per_unit;  ///< from "depth_scale_m_per_unit", 1e-6..1 m
  /// 8 or 16: "depth_bits", else from "depth" in words, else 16 if a scale is declared.
  std::optional<int> depth_bits;
  std::optional<double> fov_deg;  ///< "fov_deg", 10..170: horizontal field of view
  /// "intrinsics" {fx, fy, cx, cy}; OpenCV's convention in the file.
  std::optional<CameraModel> camera;
};

inline constexpr std::size_t kMaxMeta_bytes = 65'536;
inline constexpr int kMaxMetaDepth = 32;  ///< nesting of objects and arrays

/// Parses the text of a meta.json: a JSON object in UTF-8, at most kMaxMeta_bytes long and
/// kMaxMetaDepth deep. Null members count as missing, unknown members are ignored. Throws
/// SourceError, one line beginning with `name`, for a wrong value or another text.
[[nodiscard]] ClipMeta parseClipMeta(std::string_view text, const std::string& name);

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

/// Finds the files of a clip in `folder`. Throws SourceError. A meta.json may declare more
/// (ClipMeta). Layouts:
/// * TUM RGB-D: rgb.txt and depth.txt with lines "timestamp file". Each colour frame pairs with the
///   nearest depth frame within 20 ms (used once). 5000 units per metre, a Kinect's field of view.
/// * Otherwise rgb/ or color/ and depth/, each with the same number of PNG or JPEG files, paired in
///   order of their names (numbers in names by value). An optional mask/ has as many files, or
///   fewer: key masks for the colour images of the same name.
[[nodiscard]] ClipFiles findClipFiles(const std::filesystem::path& folder);

/// Returns whether `a` sorts before `b`, with runs of digits compared by value: frame2 < frame10.
[[nodiscard]] bool naturalLess(const std::string& a, const std::string& b);

}  // namespace hapticast::server
