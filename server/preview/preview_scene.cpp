// SPDX-License-Identifier: MIT
#include "server/preview/preview_scene.hpp"

#include <cmath>
#include <filesystem>

#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

void addObject(Scene& scene, AuthorPoint point) {
  point.number = static_cast<int>(scene.objects.size()) + 1;
  scene.objects.push_back({"object " + std::to_string(point.number), {point}, {}, {}});
}

}  // namespace

Scene completeScene(const Settings& settings, const PreviewFrame& first, const SourceInfo& info) {
  Scene scene = settings.scene;
  for (SceneObject& object : scene.objects) {
    for (KeyMaskFile& mask : object.masks) {
      const auto folder = std::filesystem::path(settings.vision.scene_file).parent_path();
      mask.file = std::filesystem::proximate(folder / mask.file, settings.preview).string();
    }
  }
  const bool named = !scene.objects.empty();
  if (!named && !info.key_masks) {
    std::erase_if(scene.object_points, [&scene](const AuthorPoint& point) {
      const bool at_start = point.time_s == 0.0 && scene.objects.size() < kMaxObjects;
      if (at_start) addObject(scene, point);
      return at_start;
    });
  }
  if (!scene.objects.empty() || !scene.object_points.empty() || info.key_masks) return scene;
  for (const std::uint32_t id : listIds(first.haptic)) {
    const cv::Point at = findDeepestPoint(renderMask(first.haptic, id, first.color.size()));
    const Vec2 own_px = Vec2(at.x + 0.5, at.y + 0.5).cwiseProduct(first.own_px);
    addObject(scene, {{std::floor(own_px.x()), std::floor(own_px.y())}, 0.0});
  }
  return scene;
}

}  // namespace hapticast::server
