// SPDX-License-Identifier: MIT
// Parser of meta.json, the author's declarations about a clip. Thread: any.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// The author's declarations in the meta.json of a clip; nullopt: not declared.
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

/// Returns the declarations in the text of a meta.json. It must be a JSON object in UTF-8, at most
/// kMaxMeta_bytes long and 32 levels deep. Members that are null or unknown are ignored. Throws
/// SourceError if a value is wrong, a member appears twice, or the text is not such an object. The
/// message is one line that begins with `name`, line and column.
[[nodiscard]] ClipMeta parseClipMeta(std::string_view text, const std::string& name);

}  // namespace hapticast::server
