// SPDX-License-Identifier: MIT
#include "server/vision/motion/object_pose.hpp"

namespace hapticast::server {

Vec3 NominalFrame::mmPerStep() const {
  const Vec2 scale = workspace.mmPerPixel();
  return {scale.x(), -scale.y(), -workspace.depth_mm / (range.far_mm - range.near_mm)};
}

Sample NominalFrame::sample(const ObjectPose& pose, double time_s) const {
  const Vec2 plane = workspace.toNominal({pose.u_px, pose.v_px});
  const Vec3 step = mmPerStep();
  const double height = (pose.depth_mm - range.far_mm) * step.z();
  return {.time_s = time_s,
          .position_mm = {plane.x(), plane.y(), height},
          .angle_rad = pose.angle_rad,
          .depth_seen = pose.depth_seen,
          .seen = pose.seen,
          .confident = pose.confident,
          .background_mm = {step.x() * pose.background_px[0], step.y() * pose.background_px[1], 0}};
}

}  // namespace hapticast::server
