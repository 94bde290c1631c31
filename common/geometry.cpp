// SPDX-License-Identifier: MIT
#include "common/geometry.hpp"

#include <algorithm>

namespace hapticast {

namespace {
// Range of z in the device's workspace, nominal mm: from 5 mm below the picture's plane to 35 mm of
// air above the relief.
constexpr double kDepthRange_mm = 70.0;
constexpr double kDepthCentre_mm = 30.0;
}  // namespace

Vec2 Workspace::mmPerPixel() const noexcept {
  const Vec2 each(width_mm / width_px, height_mm / height_px);
  return stretch ? each : Vec2::Constant(each.minCoeff());
}

Vec2 Workspace::toNominal(const Vec2& image_px) const noexcept {
  const Vec2 scale = mmPerPixel();
  return {(image_px.x() - 0.5 * width_px) * scale.x(),
          (0.5 * height_px - image_px.y()) * scale.y()};
}

DeviceMapping DeviceMapping::fit(const Workspace& workspace, const Vec3& device_mm) noexcept {
  const Vec3 nominal_mm(workspace.width_mm, workspace.height_mm, kDepthRange_mm);
  return {device_mm.cwiseQuotient(nominal_mm).minCoeff(), {0.0, 0.0, kDepthCentre_mm}};
}

Vec3 DeviceMapping::toDevice(const Vec3& nominal_mm) const noexcept {
  return scale * (nominal_mm - centre_nominal_mm);
}

Vec3 DeviceMapping::toNominal(const Vec3& device_mm) const noexcept {
  return device_mm / scale + centre_nominal_mm;
}

}  // namespace hapticast
