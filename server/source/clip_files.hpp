// SPDX-License-Identifier: MIT
// Finds the files of an image sequence in its folder: colour, depth, masks and the author's
// declarations. findClipFiles() describes the supported layouts. It opens no image. Thread: any.
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

/// What the author declared about a clip in its meta.json. A member is nullopt if it is not
/// declared.
struct ClipMeta {
  std::optional<double> fps;          ///< from "fps", 1..240 frames/s
  std::optional<double> mm_per_unit;  ///< from "depth_scale_m_per_unit", 1e-6..1 m/unit
  /// Bits of depth, 8 or 16: the number in "depth_bits", or else the number that the text of
  /// "depth" mentions. If neither has a number but a scale is declared, it is 16.
  std::optional<int> depth_bits;
  std::optional<double> fov_deg;  ///< from "fov_deg", 10..170: horizontal field of view
  std::optional<int> width_px;    ///< from "width"
  std::optional<int> height_px;   ///< from "height"
  /// From "intrinsics" {fx, fy, cx, cy}. The file has cx and cy in OpenCV's convention, so half a
  /// pixel is added to both.
  std::optional<CameraModel> camera;
};

inline constexpr std::size_t kMaxMeta_bytes = 65'536;
inline constexpr int kMaxMetaDepth = 32;  ///< deepest nesting of objects and arrays

/// Returns the declarations in the text of a meta.json. It must be a JSON object in UTF-8, at most
/// kMaxMeta_bytes long and kMaxMetaDepth deep. Members that are null or unknown are ignored. Throws
/// SourceError if a value is wrong or the text is not such an object. The message is one line that
/// begins with `name`.
[[nodiscard]] ClipMeta parseClipMeta(std::string_view text, const std::string& name);

/// Files of one frame.
struct FrameFiles {
  std::filesystem::path color;
  std::filesystem::path depth;
  std::filesystem::path mask;  ///< mask file; empty: the frame has none
};

/// Files of a clip with their declarations.
struct ClipFiles {
  std::vector<FrameFiles> frames;  ///< in order of time, at least one
  /// True: the masks are key masks, which only some frames have.
  bool key_masks = false;
  double fps = 25.0;                       ///< frames/s
  std::optional<int> declared_depth_bits;  ///< bits of depth that the author declared, 8 or 16
  double mm_per_unit = 1.0;                ///< mm for each unit of 16-bit depth
  std::optional<CameraModel> camera;
  std::optional<double> fov_deg;  ///< horizontal field of view, if no camera is declared
  std::optional<int> declared_width_px;
  std::optional<int> declared_height_px;
};

/// Returns the files of the clip in `folder`, with the declarations of its meta.json if it has one.
/// Throws SourceError. The layouts are:
/// * TUM RGB-D: rgb.txt and depth.txt have lines "timestamp file". Each colour frame is paired with
///   the nearest depth frame at most 20 ms away. No depth frame is used twice. Depth has 5000 units
///   per metre, and the field of view is a Kinect's.
/// * Otherwise rgb/ or color/ and depth/ each have the same number of PNG or JPEG files. They are
///   paired in the order of their names (numbers in names count by value). If the frame numbers of
///   a pair differ, the log gets one warning.
/// * The second layout may also have mask/. If mask/ has as many files as the colour folder, each
///   frame has a mask. If it has fewer, they are key masks for the colour images of the same names.
[[nodiscard]] ClipFiles findClipFiles(const std::filesystem::path& folder);

/// Returns whether name `a` comes before name `b`. Numbers in names are compared by value: frame2 <
/// frame10.
[[nodiscard]] bool naturalLess(const std::string& a, const std::string& b);

}  // namespace hapticast::server
