// SPDX-License-Identifier: MIT
// Parser of meta.json, the author's declarations about a clip. Thread: any.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

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

}  // namespace hapticast::server
