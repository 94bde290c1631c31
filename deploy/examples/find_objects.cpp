// SPDX-License-Identifier: MIT
// Runs vision on images of its own: a ball that bounces in front of a wall. Prints its motion.
#include <cmath>
#include <cstdio>
#include <exception>

#include "hapticast/vision.hpp"

namespace {

/// Returns the images at `time_s`: a ball of 120 mm radius, 1 m away, that falls and bounces.
hapticast::Images drawImages(double time_s) {
  hapticast::Images images;
  images.width_px = 320;
  images.height_px = 240;
  images.time_s = time_s;
  images.rgb.resize(320 * 240 * 3, 90);
  images.depth.resize(320 * 240, 1400.0F);
  const double fall_s = std::fmod(time_s, 0.8) - 0.4;
  const double middle_v = 50.0 + 0.5 * 900.0 * fall_s * fall_s;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const double radius = std::hypot(u - 160.0, v - middle_v) / 40.0;
      if (radius >= 1.0) continue;
      const auto at = static_cast<std::size_t>(320 * v + u);
      images.depth[at] = static_cast<float>(1120.0 - 120.0 * std::sqrt(1.0 - radius * radius));
      images.rgb[3 * at] = (u / 4 + v / 4) % 2 == 0 ? 220 : 180;
    }
  }
  return images;
}

}  // namespace

int main() try {
  hapticast::SourceInfo info;
  info.width_px = 320;
  info.height_px = 240;
  info.fps = 30.0;
  info.camera = {333.0, 333.0, 160.0, 120.0};
  hapticast::VisionSettings settings;
  settings.objects = {{160.0, 122.0}};  // a point on the ball in the first images
  hapticast::Vision vision(info, settings);
  for (int i = 0; i < 60; ++i) {
    const auto frame = vision.push(drawImages(i / info.fps));
    if (!frame) continue;
    for (const hapticast::Object& object : frame->objects)
      std::printf("%.2f s: object %u at y %.1f mm, %.0f mm/s, %zu impacts\n", frame->time_s,
                  object.id, object.position_mm.y(), object.velocity_mm_s.y(),
                  object.impacts.size());
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "find_objects: %s\n", error.what());
  return 1;
}
