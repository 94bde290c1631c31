// SPDX-License-Identifier: MIT
// Reads the camera and the masks of a scene of the BOP benchmark (scene_camera.json, mask_visib/,
// mask/). Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "server/source/camera_model.hpp"
#include "server/source/folder/clip_files.hpp"

namespace hapticast::server {

inline constexpr std::size_t kMaxScene_bytes = 8U << 20U;

/// Camera of one image.
struct BopCamera {
  CameraModel camera;  ///< from "cam_K"; half a pixel is added to its centre, as to meta.json's
  double mm_per_unit = 1.0;  ///< from "depth_scale", 1e-3..1000
};

/// Returns the cameras in the text of a scene_camera.json by the numbers of their images. It must
/// be a JSON object in UTF-8, at most kMaxScene_bytes long. Throws SourceError with one line that
/// begins with `name` if it is none, or if a value is wrong.
[[nodiscard]] std::map<std::uint32_t, BopCamera> parseSceneCamera(std::string_view text,
                                                                  const std::string& name);

/// Adds the camera, the scale of each depth image and the masks of the BOP scene in `folder` to
/// `clip`, whose frames are found. `text`: that of its scene_camera.json. Masks are those of the
/// visible parts (mask_visib/), else mask/: IMAGE_OBJECT.png, where object 0 becomes number 1.
/// Objects after the 16th are left out with a warning. Throws SourceError.
void addBopScene(const std::filesystem::path& folder, std::string_view text, ClipFiles& clip);

}  // namespace hapticast::server
