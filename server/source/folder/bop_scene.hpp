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
#include "server/source/folder/frame_files.hpp"

namespace hapticast::server {

inline constexpr std::size_t kMaxScene_bytes = 8U << 20U;

/// Camera of one image.
struct BopCamera {
  CameraModel camera;        ///< from "cam_K", with half a pixel added to cx and cy (clip_meta.hpp)
  double mm_per_unit = 1.0;  ///< from "depth_scale", 1e-3..1000
};

/// Returns the cameras in the text of a scene_camera.json by the numbers of their images. It must
/// be a JSON object in UTF-8, at most kMaxScene_bytes long. Throws SourceError if the text is no
/// such object, or if a value is wrong. The message is one line that begins with `name`.
[[nodiscard]] std::map<std::uint32_t, BopCamera> parseSceneCamera(std::string_view text,
                                                                  const std::string& name);

/// Adds the camera, the scale of each depth image and the masks of the BOP scene in `folder` to
/// `clip`, which already has its frames. `text`: content of scene_camera.json. It uses the masks of
/// visible parts (mask_visib/) if they exist, else mask/. Their names are IMAGE_OBJECT.png, and
/// object 0 becomes number 1. Objects after the 16th are left out with a warning. Throws
/// SourceError.
void addBopScene(const std::filesystem::path& folder, std::string_view text, ClipFiles& clip);

}  // namespace hapticast::server
