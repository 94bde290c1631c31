// SPDX-License-Identifier: MIT
// Parser and writer of scene files, the author's work on a clip: objects with names, points, key
// masks and material, and the author's flags. A scene file is JSON (scene.schema.json). It contains
// only texts and numbers: it cannot select a source or start a command. Thread: main, at start-up.
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/source/camera_model.hpp"
#include "server/source/key_mask_file.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Flags with their values: the name without "--", and the text as on the command line.
using FlagTexts = std::vector<std::pair<std::string, std::string>>;

/// Flags that a scene file can set.
inline constexpr auto kSceneFlags = std::to_array<const char*>(
    {"compensate-pan", "damping",   "depth-code", "depth-near", "depth-range",
     "error-budget",   "fov",       "fps",        "friction",   "layout",
     "low-latency",    "map-range", "mass",       "method",     "motion",
     "name",           "plan",      "segment",    "stiffness",  "stretch",
     "texture-depth",  "to-and-fro"});

/// One object of a scene. Its number is its position in the scene, from 1.
struct SceneObject {
  std::string name;
  std::vector<AuthorPoint> points;
  std::vector<KeyMaskFile> masks;  ///< `file`: as in the scene file, relative to its folder
  FlagTexts flags;                 ///< its material and mass
  bool operator==(const SceneObject&) const = default;
};

/// Content of a scene file.
struct Scene {
  FlagTexts flags;
  /// Intrinsics of the colour camera in OpenCV's convention, as in the file: cx and cy are half a
  /// pixel smaller than elsewhere in the server.
  std::optional<CameraModel> camera;
  std::vector<AuthorPoint> object_points;  ///< of objects without a name
  std::vector<AuthorPoint> not_points;
  std::vector<SceneObject> objects;  ///< at most kMaxObjects
  bool operator==(const Scene&) const = default;
};

/// Returns the scene in `text`. The values of flags are not checked. Throws JsonError.
[[nodiscard]] Scene parseScene(std::string_view text);

/// Returns `scene` as the text of a scene file. parseScene() returns an equal scene for it.
[[nodiscard]] std::string formatScene(const Scene& scene);

}  // namespace hapticast::server
