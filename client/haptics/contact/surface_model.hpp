// SPDX-License-Identifier: MIT
// Where the tip should be: displacement from the HIP to the surface. Knows geometry only, no
// stiffness. Real-time room: noexcept, no heap, no locks.
#pragma once

#include "client/haptics/contact/surface_kind.hpp"
#include "client/haptics/playback/scene.hpp"

namespace hapticast::client {

// What this viewer takes where the author's Material says nothing (stiffness: the device
// profile's). Chosen: a surface as it is without an author, and the thesis's K. One of the two
// coefficients of friction alone says both.
inline constexpr double kDefaultDamping_Ns_m = 0.0;  // beside what keeps the wall stable
inline constexpr double kDefaultFriction = 0.0;
inline constexpr double kDefaultTextureK_mm = 30.0;

/// All in nominal mm, device axes.
struct Contact {
  Vec3 displacement_mm = Vec3::Zero();        ///< from the HIP to where it should be
  Vec3 normal = Vec3::UnitZ();                ///< unit, out of the surface
  Vec3 surface_velocity_mm_s = Vec3::Zero();  ///< of the surface at the contact
  double depth_mm = 0.0;                      ///< penetration along the normal: d / sqrt(1 + |g|²)
  bool contact = false;
  bool jump = false;  ///< the geometry changed by more than motion explains: a new epoch,
                      ///< or the touched object has just appeared
  double stiffness_factor = 1.0;  ///< |displacement| over depth along the normal (perturbed: > 1)
  const InterpolatedObject* object = nullptr;  ///< the touched one
};

/// A nominal point (x, y) at play time, carried back with the object into one of its frames.
struct WarpedPoint {
  const PlayObject& frame;
  bool turns;  ///< from the frame's angle to the present one, with this cosine and sine
  double c = 1.0;
  double s = 0.0;
  Vec2 image_px;  ///< where it is in that frame

  /// `px_per_mm`: the workspace's pixelsPerMm().
  WarpedPoint(const PlayObject& in, const InterpolatedObject& now, const Vec2& nominal_mm,
              const Workspace& workspace, const Vec2& px_per_mm) noexcept;
  /// These require a relief that shows().
  [[nodiscard]] bool inside() const noexcept { return frame.field->inside(image_px); }
  /// Height above the reference point; the gradient at the object's present angle.
  [[nodiscard]] SurfaceSample shape() const noexcept;
};

/// Height and gradient (nominal frame) of an object under the nominal point (x, y) at play time,
/// with the relief carried along: (1-s) (H_a(q + p_a) - p_a,z) + s (H_b(q + p_b) - p_b,z) + p(t)_z,
/// q = rotated back (x, y) - p(t). `inside`: the point is in the mask (of the nearer frame);
/// elsewhere nothing is told.
struct SurfacePoint {
  SurfaceSample sample;
  bool inside = false;
  double shape_rate_mm_s =
      0.0;  ///< how fast the height changes by the change of shape alone (inside both masks)
};
SurfacePoint evaluateSurface(const InterpolatedObject& object, const Vec2& nominal_mm,
                             const Workspace& workspace) noexcept;

/// Eq. 2-4 on one sample: displacement F/k of the memoryless models at depth d = h - z > 0.
/// K of Eq. 3 in mm; h_bar = height / depth_mm. Returned in nominal mm.
Vec3 perturbedDisplacement(double depth_mm, double height_mm, const Vec2& gradient,
                           double texture_K_mm, double workspace_depth_mm) noexcept;

/// The plane through a surface point that lies `depth_mm` above the tip along z, with the surface's
/// gradient there.
struct TangentPlane {
  Vec3 displacement_mm;  ///< from the tip to the nearest point of the plane, d / (1 + |g|²) M
  Vec3 normal;           ///< unit
  double depth_mm;       ///< of the tip along it
};
TangentPlane tangentPlane(double depth_mm, const Vec2& gradient) noexcept;

/// Contact of the HIP with one object; `jump` if the object has just appeared.
Contact computeObjectContact(SurfaceKind kind, const InterpolatedObject& object, const Vec3& hip_mm,
                             const Workspace& workspace) noexcept;

/// The contact that is deepest along its normal over all objects of the scene. Outside the masks,
/// and for objects whose relief never arrived, there is nothing to touch.
Contact findContact(SurfaceKind kind, const Scene& scene, const Vec3& hip_mm,
                    const Workspace& workspace) noexcept;

}  // namespace hapticast::client
