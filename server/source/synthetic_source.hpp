// SPDX-License-Identifier: MIT
// Renderer of the synthetic scenes: exact depth and mask at pixel centres, textured colour. Thread:
// one.
#pragma once

#include "server/source/rgbd_source.hpp"
#include "server/source/synthetic_scene.hpp"

namespace hapticast::server {

/// Returns a lit texture colour: `part` 0..1 between `dark` and `light` (BGR, 0..255), times
/// `brightness`.
cv::Vec3b mix(const cv::Vec3f& dark, const cv::Vec3f& light, float part, float brightness);
/// Lambertian shading with much ambient light from above left: shape is visible, but texture
/// changes little with rotation. `normal`: outward, camera frame, any length.
float brightness(const Vec3& normal);

/// Source of one synthetic scene.
class SyntheticSource final : public RgbdSource {
 public:
  /// Frame n shows the scene at n / fps; the clip lasts scene.duration_s(). `fps`: 1..240. Size:
  /// 1..1920 x 1..1080 px.
  explicit SyntheticSource(SceneKind kind, double fps = 25.0, int width_px = 640,
                           int height_px = 480);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

  /// Returns the ground truth of the pictures (the whole picture is fitted into 160 x 120 mm).
  [[nodiscard]] const SyntheticScene& scene() const { return scene_; }

 private:
  void draw(const SceneInstant& instant, RgbdFrame& frame) const;

  SyntheticScene scene_;
  SourceInfo info_;
  SolidNoise noise_;
  cv::Mat background_;  // colour
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
};

}  // namespace hapticast::server
