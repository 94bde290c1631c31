// SPDX-License-Identifier: MIT
#include "server/source/folder/bop_scene.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "common/haptic_frame.hpp"
#include "common/json/json_document.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

/// Returns the number that is the whole of `text`.
std::optional<std::uint32_t> parseIndex(std::string_view text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

bool isSameCamera(const CameraModel& a, const CameraModel& b) {
  constexpr double kSame = 0.01;  // chosen
  return std::abs(a.fx_px - b.fx_px) <= kSame * a.fx_px &&
         std::abs(a.fy_px - b.fy_px) <= kSame * a.fy_px &&
         std::abs(a.cx_px - b.cx_px) <= kSame * a.fx_px &&
         std::abs(a.cy_px - b.cy_px) <= kSame * a.fy_px;
}

void addCameras(const std::string& name, const std::map<std::uint32_t, BopCamera>& cameras,
                ClipFiles& clip) {
  bool differs = false;
  for (FrameFiles& frame : clip.frames) {
    const auto image = parseIndex(frame.color.stem().string());
    const auto camera = image ? cameras.find(*image) : cameras.end();
    if (camera == cameras.end()) {
      throw SourceError(name + ": has no camera for " + frame.color.filename().string() +
                        "; add it, or remove the image");
    }
    frame.mm_per_unit = camera->second.mm_per_unit;
    if (!clip.camera) clip.camera = camera->second.camera;
    differs = differs || !isSameCamera(*clip.camera, camera->second.camera);
  }
  if (!differs) return;
  spdlog::warn("--source {}: its images have different cameras; the server uses that of the first",
               name);
}

void addObjectMasks(const fs::path& folder, ClipFiles& clip) {
  std::map<std::uint32_t, FrameFiles*> frames;
  for (FrameFiles& frame : clip.frames) {
    if (const auto image = parseIndex(frame.color.stem().string())) frames[*image] = &frame;
    frame.object_masks.resize(1);
  }
  bool too_many = false;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    const std::size_t line = stem.find('_');
    if (entry.path().extension() != ".png" || line == std::string::npos) continue;
    const auto image = parseIndex(std::string_view(stem).substr(0, line));
    const auto object = parseIndex(std::string_view(stem).substr(line + 1));
    const auto frame = image ? frames.find(*image) : frames.end();
    if (!object || frame == frames.end()) continue;
    too_many = too_many || *object >= kMaxObjects;
    if (*object >= kMaxObjects) continue;
    std::vector<fs::path>& masks = frame->second->object_masks;
    masks.resize(std::max<std::size_t>(masks.size(), *object + 1));
    masks[*object] = entry.path();
  }
  if (too_many)
    spdlog::warn("--source {}: has more than {} objects in an image; the rest is left out",
                 folder.string(), kMaxObjects);
}

std::map<std::uint32_t, BopCamera> readCameras(JsonObject scene) {
  std::map<std::uint32_t, BopCamera> cameras;
  for (const auto& [key, value] : scene.value().items()) {
    const auto image = parseIndex(key);
    if (!image || !value.is_object()) scene.refuse(key, "is not the camera of an image");
    JsonObject camera = scene.object(key);
    const auto matrix = camera.numbers("cam_K", 9, -1e5, 1e5);
    if (!(matrix[0] >= 1.0 && matrix[4] >= 1.0))
      camera.refuse("cam_K", "has no focal length of 1 px or more");
    cameras[*image] = {{matrix[0], matrix[4], matrix[2] + 0.5, matrix[5] + 0.5},
                       camera.number("depth_scale", 1e-3, 1e3).value_or(1.0)};
  }
  return cameras;
}

}  // namespace

std::map<std::uint32_t, BopCamera> parseSceneCamera(std::string_view text,
                                                    const std::string& name) {
  try {
    const JsonDocument document = parseJson(text, {.most_bytes = kMaxScene_bytes});
    return readCameras(JsonObject(document));
  } catch (const JsonError& error) {
    throw SourceError(describe(name, error) + "; mend or remove the file");
  }
}

void addBopScene(const fs::path& folder, std::string_view text, ClipFiles& clip) {
  const std::string name = (folder / "scene_camera.json").string();
  addCameras(name, parseSceneCamera(text, name), clip);
  clip.declared_depth_bits = 16;
  for (const char* masks : {"mask_visib", "mask"}) {
    if (!fs::is_directory(folder / masks)) continue;
    addObjectMasks(folder / masks, clip);
    return;
  }
}

}  // namespace hapticast::server
