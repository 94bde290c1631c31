// SPDX-License-Identifier: MIT
// Surface models: the displacement from the HIP to the surface. The models are pure geometry,
// without a stiffness. Perturbed: Eq. 3 of the thesis divided by k. Normal: the distance to the
// tangent plane. The model `proxy` has a state and lives in proxy_surface.hpp.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/playback/scene.hpp"
#include "client/haptics/user_controls.hpp"

namespace hapticast::client {

// Values of this client where the author's Material has no value. The default stiffness is in the
// device profile. Chosen: a surface without friction or additional damping, and the thesis's K. If
// an author states one of the two friction coefficients, it counts for both.
inline constexpr double kDefaultDamping_Ns_m = 0.0;  // in addition to the damping of the wall law
inline constexpr double kDefaultFriction = 0.0;
inline constexpr double kDefaultTextureK_mm = 30.0;

/// A contact in nominal mm, axes of the device frame.
struct Contact {
  Vec3 displacement_mm = Vec3::Zero();        ///< from the HIP to its surface point
  Vec3 normal = Vec3::UnitZ();                ///< unit, out of the surface
  Vec3 surface_velocity_mm_s = Vec3::Zero();  ///< velocity of the surface at the contact
  double depth_mm = 0.0;                      ///< penetration along the normal: d / sqrt(1 + |g|²)
  bool contact = false;
  /// The geometry changed by more than motion explains: new epoch, or the object appeared.
  bool jump = false;
  double stiffness_factor = 1.0;  ///< |displacement| / depth along the normal (perturbed: > 1)
  const InterpolatedObject* object = nullptr;  ///< touched object
};

/// Backward warp of a nominal point (x, y) at play time into one frame of its object.
struct WarpedPoint {
  const PlayObject& frame;
  bool turns;  ///< the angle differs from the frame's; c, s: cosine and sine of the difference
  double c = 1.0;
  double s = 0.0;
  Vec2 image_px;  ///< position in that frame's picture

  /// Warps `nominal_mm` into the frame `in`. `px_per_mm` is workspace.pixelsPerMm(). `in` must
  /// outlive this object.
  WarpedPoint(const PlayObject& in, const InterpolatedObject& now, const Vec2& nominal_mm,
              const Workspace& workspace, const Vec2& px_per_mm) noexcept;
  /// Returns true if the point lies in the mask. Requires shows(&frame).
  [[nodiscard]] bool inside() const noexcept { return frame.field->inside(image_px); }
  /// Height above the reference point, mm, and the gradient at the object's present angle. Requires
  /// shows(&frame).
  [[nodiscard]] SurfaceSample shape() const noexcept;
};

/// Surface of an object under a nominal point (x, y) at play time:
///   height = (1-s) (H_a(q + p_a) - p_a,z) + s (H_b(q + p_b) - p_b,z) + p(t)_z
/// where q is (x, y) - p(t), turned back. `inside`: the point is in the mask of the nearer frame.
/// Without `inside` the other members are not set.
struct SurfacePoint {
  SurfaceSample sample;
  bool inside = false;
  /// Change of the height by the change of shape alone, mm/s; 0 outside either mask.
  double shape_rate_mm_s = 0.0;
};
SurfacePoint evaluateSurface(const InterpolatedObject& object, const Vec2& nominal_mm,
                             const Workspace& workspace) noexcept;

/// Returns the displacement F/k of Eq. 2-4 (nominal mm) at the depth d = h - z > 0. `texture_K_mm`
/// is K of Eq. 3, and h_bar = height_mm / workspace_depth_mm.
Vec3 perturbedDisplacement(double depth_mm, double height_mm, const Vec2& gradient,
                           double texture_K_mm, double workspace_depth_mm) noexcept;

/// Tangent plane through a surface point.
struct TangentPlane {
  Vec3 displacement_mm;  ///< from the HIP to the nearest point of the plane, d / (1 + |g|²) M
  Vec3 normal;           ///< unit
  double depth_mm;       ///< depth of the HIP along `normal`
};
/// Returns the plane through the surface point that lies `depth_mm` above the HIP along z and has
/// this `gradient`.
TangentPlane tangentPlane(double depth_mm, const Vec2& gradient) noexcept;

/// Returns the contact of the HIP with one object. `jump` is set if the object appeared. `kind` is
/// kNormal or kPerturbed.
Contact computeObjectContact(SurfaceKind kind, const InterpolatedObject& object, const Vec3& hip_mm,
                             const Workspace& workspace) noexcept;

/// Returns the deepest contact (along its normal) over all objects of `scene`. There is no contact
/// outside the masks, and none with an object whose relief never arrived. `kind` is kNormal or
/// kPerturbed.
Contact findContact(SurfaceKind kind, const Scene& scene, const Vec3& hip_mm,
                    const Workspace& workspace) noexcept;

}  // namespace hapticast::client
