// SPDX-License-Identifier: MIT
// What the author of a clip says about it in meta.json. Thread: any.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

struct ClipMeta {
  std::optional<double> fps;          ///< "fps", 1..240
  std::optional<double> mm_per_unit;  ///< from "depth_scale_m_per_unit", 1e-6..1 m
  std::optional<int> depth_bits;  ///< 8 or 16: "depth_bits", else "depth" in words, else 16 where
                                  ///< a scale is given
  std::optional<double> fov_deg;  ///< "fov_deg", 10..170: how wide the picture is
  std::optional<CameraModel> camera;  ///< "intrinsics" {fx, fy, cx, cy} in OpenCV's convention
};

inline constexpr std::size_t kMaxMeta_bytes = 65'536;
inline constexpr int kMaxMetaDepth = 32;  ///< objects and arrays in each other

/// Reads the text of a meta.json: a JSON object in UTF-8, at most kMaxMeta_bytes long and
/// kMaxMetaDepth deep. What is null or not there is not said; what is not known is passed over.
/// Throws SourceError, one line beginning with `name`, where a value is wrong or the text is no
/// such object.
[[nodiscard]] ClipMeta parseClipMeta(std::string_view text, const std::string& name);

}  // namespace hapticast::server
