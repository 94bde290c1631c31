// SPDX-License-Identifier: MIT
#include "server/source/synthetic/synthetic_source.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::server {

namespace {

cv::Mat paintBackground(const SolidNoise& noise, int width_px, int height_px) {
  cv::Mat picture(height_px, width_px, CV_8UC3);
  const double mm_per_px = 640.0 / width_px;
  for (int v = 0; v < height_px; ++v) {
    auto* row = picture.ptr<cv::Vec3b>(v);
    for (int u = 0; u < width_px; ++u) {
      const float part = noise.at({u * mm_per_px, v * mm_per_px, 300.0});
      row[u] = mix({70, 60, 45}, {150, 140, 115}, part, 1.0F);
    }
  }
  return picture;
}

Workspace makeImageWorkspace(int width_px, int height_px) {
  Workspace workspace;
  workspace.width_px = width_px;
  workspace.height_px = height_px;
  return workspace;
}

}  // namespace

cv::Vec3b mix(const cv::Vec3f& dark, const cv::Vec3f& light, float part, float brightness) {
  const cv::Vec3f color = (dark + part * (light - dark)) * brightness;
  return {cv::saturate_cast<std::uint8_t>(color[0]), cv::saturate_cast<std::uint8_t>(color[1]),
          cv::saturate_cast<std::uint8_t>(color[2])};
}

float brightness(const Vec3& normal) {
  const Vec3 to_light = Vec3(-0.4, -0.6, -0.7).normalized();  // from above left, behind the camera
  return 0.6F + 0.45F * static_cast<float>(std::max(0.0, normal.normalized().dot(to_light)));
}

SyntheticSource::SyntheticSource(SceneKind kind, double fps, int width_px, int height_px)
    : scene_(kind, makeImageWorkspace(width_px, height_px)),
      background_(paintBackground(noise_, width_px, height_px)) {
  const auto* const entry = std::find_if(kSceneNames.begin(), kSceneNames.end(),
                                         [&](const SceneName& name) { return name.kind == kind; });
  info_.name = "synthetic:" + std::string(entry->name);
  info_.width_px = width_px;
  info_.height_px = height_px;
  info_.fps = fps;
  info_.depth_kind = DepthKind::kMetric;
  info_.frame_count = static_cast<std::uint64_t>(std::llround(scene_.duration_s() * fps));
  info_.depth_range = scene_.view().range;
  info_.camera = scene_.view().camera;
}

std::optional<RgbdFrame> SyntheticSource::read() {
  if (next_ >= *info_.frame_count) return std::nullopt;
  RgbdFrame frame;
  frame.index = next_;
  frame.epoch = epoch_;
  frame.clip_time_s = static_cast<double>(next_) / info_.fps;
  frame.color = background_.clone();
  frame.depth = cv::Mat(background_.size(), CV_32FC1, cv::Scalar(scene_.background_mm()));
  frame.mask = cv::Mat::zeros(background_.size(), CV_8UC1);
  draw(scene_.at(frame.clip_time_s), frame);
  ++next_;
  return frame;
}

bool SyntheticSource::skip() {
  if (next_ >= *info_.frame_count) return false;
  ++next_;
  return true;
}

void SyntheticSource::rewind() {
  next_ = 0;
  ++epoch_;
}

void SyntheticSource::draw(const SceneInstant& instant, RgbdFrame& frame) const {
  const PixelRect box = instant.boundingBox();
  const Eigen::Matrix3d to_body = instant.body().rotation.transpose();
  for (int v = box.v; v < box.v + box.height; ++v) {
    auto* color = frame.color.ptr<cv::Vec3b>(v);
    auto* depth = frame.depth.ptr<float>(v);
    auto* mask = frame.mask.ptr<std::uint8_t>(v);
    for (int u = box.u; u < box.u + box.width; ++u) {
      const auto hit = instant.hit({u + 0.5, v + 0.5});
      if (!hit) continue;
      depth[u] = static_cast<float>(hit->position_mm.z());
      mask[u] = 1;
      const Vec3 in_body = to_body * (hit->position_mm - instant.body().position_mm);
      color[u] = mix({30, 60, 140}, {130, 215, 250}, noise_.at(in_body), brightness(hit->normal));
    }
  }
}

}  // namespace hapticast::server
