// SPDX-License-Identifier: MIT
// Surface models: they compute the displacement from the HIP to the surface. They are pure
// geometry, without a stiffness. The model `perturbed` is Eq. 3 of the thesis, divided by the
// stiffness k. The model `normal` is the shortest vector to the tangent plane. The model `proxy`
// has a state and is in proxy_surface.hpp.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/playback/scene.hpp"
#include "client/haptics/user_controls.hpp"

namespace hapticast::client {

// Defaults of this client, for values that the author's Material does not have. The default
// stiffness is in the device profile. The values are a choice: no friction, no additional damping,
// and K of Eq. 3 as in the thesis. If an author states only one of the two friction coefficients,
// it counts for both.
inline constexpr double kDefaultDamping_Ns_m = 0.0;  // added to the damping of the wall law
inline constexpr double kDefaultFriction = 0.0;
inline constexpr double kDefaultTextureK_mm = 30.0;

/// A contact in nominal mm. The axes are those of the device frame.
struct Contact {
  Vec3 displacement_mm = Vec3::Zero();        ///< vector from the HIP to its surface point
  Vec3 normal = Vec3::UnitZ();                ///< unit vector out of the surface
  Vec3 surface_velocity_mm_s = Vec3::Zero();  ///< velocity of the surface at the contact point
  double depth_mm = 0.0;                      ///< depth of the HIP along `normal`
  bool contact = false;
  /// The geometry changed by more than its motion explains: the epoch is new, or the object
  /// appeared.
  bool jump = false;
  /// Stiffness along the normal, divided by the stiffness along the displacement. It is above 1
  /// only for the model `perturbed`.
  double stiffness_factor = 1.0;
  const InterpolatedObject* object = nullptr;  ///< touched object
};

/// Transforms a point (x, y) at play time back into one frame of its object. `image_px` is the
/// position at which the picture of that frame shows the same point of the object.
struct WarpedPoint {
  const PlayObject& frame;
  /// True if the object's angle at play time differs from that in the frame. c and s are the cosine
  /// and sine of the difference.
  bool turns;
  double c = 1.0;
  double s = 0.0;
  Vec2 image_px;  ///< position in the picture of that frame

  /// Transforms `nominal_mm` into the received frame of the object `in`. `now` is the object at
  /// play time. `px_per_mm` is workspace.pixelsPerMm(). `in` must outlive this object.
  WarpedPoint(const PlayObject& in, const InterpolatedObject& now, const Vec2& nominal_mm,
              const Workspace& workspace, const Vec2& px_per_mm) noexcept;
  /// Returns true if the point lies inside the mask. Requires shows(&frame).
  [[nodiscard]] bool inside() const noexcept { return frame.field->inside(image_px); }
  /// Returns the height above the reference point (mm), and the gradient at the object's present
  /// angle. Requires shows(&frame).
  [[nodiscard]] SurfaceSample shape() const noexcept;
};

/// Surface of an object under a nominal point (x, y) at play time:
///   height = (1-s) (H_a(q + p_a) - p_a,z) + s (H_b(q + p_b) - p_b,z) + p(t)_z
/// H_a and H_b are the heights in the two frames around play time, p_a and p_b the positions of the
/// reference point in them. s is the blend, and q is (x, y) - p(t), rotated back by the object's
/// angle. `inside` is true if the point lies inside the mask of the frame that is nearer to play
/// time. If it is false, the other members are not set.
struct SurfacePoint {
  SurfaceSample sample;
  bool inside = false;
  /// Speed (mm/s) at which the change of the shape raises the surface. It is 0 if the point is
  /// outside the mask of either frame.
  double shape_rate_mm_s = 0.0;
};
/// Returns the surface of `object` at `nominal_mm`.
SurfacePoint evaluateSurface(const InterpolatedObject& object, const Vec2& nominal_mm,
                             const Workspace& workspace) noexcept;

/// Returns the displacement F/k of Eq. 2-4, nominal mm. `depth_mm` is the depth d = h - z of the
/// HIP below the surface, above 0. `height_mm` is the height h of the surface. `texture_K_mm` is K
/// of Eq. 3, and height_mm / workspace_depth_mm is its h_bar.
Vec3 perturbedDisplacement(double depth_mm, double height_mm, const Vec2& gradient,
                           double texture_K_mm, double workspace_depth_mm) noexcept;

/// Tangent plane of a surface at one of its points.
struct TangentPlane {
  /// Vector from the HIP to the nearest point of the plane.
  Vec3 displacement_mm;
  Vec3 normal;      ///< unit
  double depth_mm;  ///< depth of the HIP along `normal`
};
/// Returns the tangent plane through a surface point. The point lies `depth_mm` above the HIP along
/// z, and the surface has this `gradient` there.
TangentPlane tangentPlane(double depth_mm, const Vec2& gradient) noexcept;

/// Returns the contact of the HIP with one object. Contact::jump is true if the object appeared in
/// this tick. `kind` is kNormal or kPerturbed.
Contact computeObjectContact(SurfaceKind kind, const InterpolatedObject& object, const Vec3& hip_mm,
                             const Workspace& workspace) noexcept;

/// Returns the contact of the HIP with one object: that with the largest depth of the HIP along its
/// normal. An object has no contact if the HIP lies outside its mask, or if its relief never
/// arrived. `kind` is kNormal or kPerturbed.
Contact findContact(SurfaceKind kind, const Scene& scene, const Vec3& hip_mm,
                    const Workspace& workspace) noexcept;

}  // namespace hapticast::client
