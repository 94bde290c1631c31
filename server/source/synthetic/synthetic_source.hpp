// SPDX-License-Identifier: MIT
// Renders the synthetic scenes: textured colour, and exact depth and mask at the centres of pixels.
// Thread: one.
#pragma once

#include "server/source/rgbd_source.hpp"
#include "server/source/synthetic/synthetic_scene.hpp"

namespace hapticast::server {

/// Returns a colour of the texture: the mixture of `dark` (`part` 0) and `light` (`part` 1),
/// multiplied by `brightness`. Colours are BGR, 0..255.
cv::Vec3b mix(const cv::Vec3f& dark, const cv::Vec3f& light, float part, float brightness);
/// Returns the brightness of a surface with this normal, by Lambertian shading with light from
/// above left. The ambient light is strong: the shape is visible, but a rotation changes the
/// texture's brightness little. `normal`: outward, camera frame, any length.
float brightness(const Vec3& normal);

/// Source whose frames show one synthetic scene.
class SyntheticSource final : public RgbdSource {
 public:
  /// Creates a source whose frame n shows the scene at n / fps seconds. The clip has the length of
  /// scene().duration_s(). `fps`: 1..240. Size: 1..1920 x 1..1080 px.
  explicit SyntheticSource(SceneKind kind, double fps = 25.0, int width_px = 640,
                           int height_px = 480);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

  /// Returns the scene, which is the ground truth of the pictures. The whole picture is fitted into
  /// 160 x 120 mm.
  [[nodiscard]] const SyntheticScene& scene() const { return scene_; }

 private:
  void draw(const SceneInstant& instant, RgbdFrame& frame) const;

  SyntheticScene scene_;
  SourceInfo info_;
  SolidNoise noise_;
  cv::Mat background_;  // colour of the background
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
};

}  // namespace hapticast::server
