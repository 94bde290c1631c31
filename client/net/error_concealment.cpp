// SPDX-License-Identifier: MIT
#include "client/net/error_concealment.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace hapticast::client {

namespace {

/// Returns the height at an image point: bilinear between the pixel centres inside the mask, a
/// weighted mean at the mask's edge, nullopt outside.
std::optional<float> sampleHeight(const Relief& relief, const Vec2& image_px) {
  const double u = image_px.x() - relief.rect.u - 0.5, v = image_px.y() - relief.rect.v - 0.5;
  if (!(u > -1.0 && v > -1.0 && u < relief.rect.width && v < relief.rect.height))
    return std::nullopt;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.rect.width) +
           static_cast<std::size_t>(x);
  };
  const auto inside = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < relief.rect.width && y < relief.rect.height &&
           relief.mask[at(x, y)] != 0;
  };
  if (!inside(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v))))
    return std::nullopt;
  const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
  double sum = 0.0, weights = 0.0;
  for (const int y : {top, top + 1}) {
    for (const int x : {left, left + 1}) {
      if (!inside(x, y)) continue;
      const double weight = (1.0 - std::abs(u - x)) * (1.0 - std::abs(v - y));
      sum += weight * static_cast<double>(relief.height_mm[at(x, y)]);
      weights += weight;
    }
  }
  return static_cast<float>(sum / weights);  // the nearest pixel has a weight of at least 0.25
}

/// Moves a point of an object from the pose `from` to the pose `to`.
Vec2 carried(const Vec2& at_mm, const Motion& from, const Motion& to) {
  const Eigen::Rotation2Dd turn(to.angle_rad - from.angle_rad);
  return turn * (at_mm - from.position_mm.head<2>()) + to.position_mm.head<2>();
}

}  // namespace

PixelRect warpedRect(const PosedRelief& before, const Motion& now, const Workspace& workspace) {
  const PixelRect& rect = before.relief->rect;
  const Vec2 picture(workspace.width_px, workspace.height_px);
  Vec2 low = picture, high = Vec2::Zero();
  for (const int u : {rect.u, rect.u + rect.width}) {
    for (const int v : {rect.v, rect.v + rect.height}) {
      const Vec2 to_mm = carried(workspace.toNominal(Vec2(u, v)), before.motion, now);
      const Vec2 to = workspace.toImage(to_mm).cwiseMax(0.0).cwiseMin(picture);
      low = low.cwiseMin(to);
      high = high.cwiseMax(to);
    }
  }
  const Eigen::Vector2i first = low.array().floor().cast<int>();
  const Eigen::Vector2i size = high.array().ceil().cast<int>() - first.array();
  return {first.x(), first.y(), size.x(), size.y()};
}

void concealMissing(const PosedRelief& before, const Motion& now, const Workspace& workspace,
                    const std::vector<std::uint8_t>& have, Relief& to) {
  const Motion& then = before.motion;
  const auto raised = static_cast<float>(now.position_mm.z() - then.position_mm.z());
  std::size_t i = 0;
  for (int v = to.rect.v; v < to.rect.v + to.rect.height; ++v) {
    for (int u = to.rect.u; u < to.rect.u + to.rect.width; ++u, ++i) {
      if (have[i] != 0) continue;
      const Vec2 was_mm = carried(workspace.toNominal({u + 0.5, v + 0.5}), now, then);
      const auto height = sampleHeight(*before.relief, workspace.toImage(was_mm));
      to.mask[i] = height ? 1 : 0;
      to.height_mm[i] = height ? *height + raised : 0.0F;
    }
  }
}

}  // namespace hapticast::client
