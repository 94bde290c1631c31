// SPDX-License-Identifier: MIT
#include "client/haptics/contact/surface_model.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::client {

namespace {

/// v + omega x r, and the change of shape along z.
Vec3 computeVelocity(const InterpolatedObject& object, const Vec2& nominal_mm,
                     double shape_rate_mm_s) noexcept {
  const Vec2 r = nominal_mm - object.position_mm.head<2>();
  const double turn = object.angular_velocity_rad_s;
  return object.velocity_mm_s + Vec3(-turn * r.y(), turn * r.x(), shape_rate_mm_s);
}

}  // namespace

WarpedPoint::WarpedPoint(const PlayObject& in, const InterpolatedObject& now,
                         const Vec2& nominal_mm, const Workspace& workspace,
                         const Vec2& px_per_mm) noexcept
    : frame(in), turns(now.angle_rad != in.motion.angle_rad) {
  Vec2 offset_mm = nominal_mm - now.position_mm.head<2>();
  if (turns) {
    c = std::cos(now.angle_rad - in.motion.angle_rad);
    s = std::sin(now.angle_rad - in.motion.angle_rad);
    offset_mm = Vec2(c * offset_mm.x() + s * offset_mm.y(), c * offset_mm.y() - s * offset_mm.x());
  }
  image_px = workspace.toImage(in.motion.position_mm.head<2>() + offset_mm, px_per_mm);
}

SurfaceSample WarpedPoint::shape() const noexcept {
  const SurfaceSample at = frame.field->bilinear(image_px);
  const Vec2& g = at.gradient;
  return {at.height_mm - frame.motion.position_mm.z(),
          turns ? Vec2(c * g.x() - s * g.y(), s * g.x() + c * g.y()) : g};
}

SurfacePoint evaluateSurface(const InterpolatedObject& object, const Vec2& nominal_mm,
                             const Workspace& workspace) noexcept {
  SurfacePoint point;
  if (!shows(object.before)) return point;
  const Vec2 px_per_mm = workspace.pixelsPerMm();
  const WarpedPoint before(*object.before, object, nominal_mm, workspace, px_per_mm);
  bool inside = before.inside();
  const bool blended = shows(object.after) && !isSameRelief(*object.before, *object.after);
  const double s = blended ? object.blend : 0.0;
  SurfaceSample shape;
  if (blended) {
    const WarpedPoint after(*object.after, object, nominal_mm, workspace, px_per_mm);
    const bool inside_after = after.inside();
    const bool inside_both = inside && inside_after;
    inside = s < 0.5 ? inside : inside_after;
    if (!inside) return point;
    shape = before.shape();
    const SurfaceSample next = after.shape();
    if (inside_both) {
      point.shape_rate_mm_s = (next.height_mm - shape.height_mm) * object.blend_rate_1_s;
    }
    shape.height_mm = (1.0 - s) * shape.height_mm + s * next.height_mm;
    shape.gradient = (1.0 - s) * shape.gradient + s * next.gradient;
  } else if (inside) {
    shape = before.shape();
  } else {
    return point;
  }
  point.sample = {shape.height_mm + object.position_mm.z(), shape.gradient};
  point.inside = true;
  return point;
}

Vec3 perturbedDisplacement(double depth_mm, double height_mm, const Vec2& gradient,
                           double texture_K_mm, double workspace_depth_mm) noexcept {
  const Vec3 m(-gradient.x(), -gradient.y(), 1.0);                              // M = N - g (Eq. 2)
  const double threshold_mm = texture_K_mm * (height_mm / workspace_depth_mm);  // K h_bar
  if (depth_mm < threshold_mm) return depth_mm * m;
  return (depth_mm - threshold_mm) * Vec3::UnitZ() + threshold_mm * m;
}

TangentPlane tangentPlane(double depth_mm, const Vec2& gradient) noexcept {
  const Vec3 m(-gradient.x(), -gradient.y(), 1.0);
  // In this order the displacement need not wait for the root.
  const double square = 1.0 / (1.0 + gradient.squaredNorm());
  const double slant = std::sqrt(square);
  return {depth_mm * square * m, slant * m, slant * depth_mm};
}

Contact computeObjectContact(SurfaceKind kind, const InterpolatedObject& object, const Vec3& hip_mm,
                             const Workspace& workspace) noexcept {
  Contact contact;
  const Vec2 under = hip_mm.head<2>();
  const SurfacePoint point = evaluateSurface(object, under, workspace);
  const double depth_mm = point.sample.height_mm - hip_mm.z();  // Eq. 4
  // Written so that a NaN touches nothing.
  if (!point.inside || !(depth_mm > 0.0)) return contact;
  const Vec2& gradient = point.sample.gradient;
  const TangentPlane plane = tangentPlane(depth_mm, gradient);
  contact.normal = plane.normal;
  contact.depth_mm = plane.depth_mm;
  if (kind == SurfaceKind::kNormal) {
    contact.displacement_mm = plane.displacement_mm;
  } else {
    const double given_K_mm = object.before->material.texture_K_mm.value_or(kDefaultTextureK_mm);
    contact.displacement_mm = perturbedDisplacement(
        depth_mm, std::max(point.sample.height_mm, 0.0), gradient,
        given_K_mm >= 0.0 ? given_K_mm : kDefaultTextureK_mm, workspace.depth_mm);
    contact.stiffness_factor = 1.0 + gradient.squaredNorm();
  }
  contact.surface_velocity_mm_s = computeVelocity(object, under, point.shape_rate_mm_s);
  contact.contact = true;
  contact.jump = object.appeared;
  contact.object = &object;
  return contact;
}

Contact findContact(SurfaceKind kind, const Scene& scene, const Vec3& hip_mm,
                    const Workspace& workspace) noexcept {
  const std::size_t count = std::min(scene.object_count, kMaxObjects);
  // The first in place: nearly always it is the only one.
  Contact deepest =
      count > 0 ? computeObjectContact(kind, scene.objects[0], hip_mm, workspace) : Contact{};
  for (std::size_t i = 1; i < count; ++i) {
    const Contact contact = computeObjectContact(kind, scene.objects[i], hip_mm, workspace);
    if (!contact.contact) continue;
    if (!deepest.contact || contact.depth_mm > deepest.depth_mm) deepest = contact;
  }
  deepest.jump = deepest.jump || scene.jumped;
  return deepest;
}

}  // namespace hapticast::client
