// SPDX-License-Identifier: MIT
// Synthetic scenes with exact ground truth at any instant: an ellipsoid moves in front of a pinhole
// camera on an analytic path. This file has only the mathematics; synthetic_source renders the
// pictures. Scenes are immutable. Thread: any. Camera frame: X right, Y down, Z forward, mm.
// Nominal and image frames: common/geometry.hpp. Times are seconds since the start of the clip. Any
// finite value is valid, because scenes are periodic.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/geometry.hpp"
#include "common/haptic_frame.hpp"
#include "common/relief/height_field.hpp"
#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// Noise in space (value noise of three octaves): the texture of the synthetic bodies. It depends
/// on the position only. Thread: any.
class SolidNoise {
 public:
  SolidNoise();

  /// Returns the noise at a position, 0..1 with a mean of about 0.5. It is smooth and the same in
  /// every run. The finest detail is about 6 mm wide, and the pattern repeats every 768 mm.
  [[nodiscard]] float at(const Vec3& position_mm) const noexcept;

 private:
  std::vector<float> lattice_;
};

enum class SceneKind : std::uint8_t {
  kBounce,  ///< a ball that bounces under gravity between floor and walls, parallel to the picture
  kApproach,  ///< a ball that oscillates along the optical axis
  /// An ellipsoid with axes 1 : 0.7 : 0.8. It rotates about a tilted axis, and its centre moves on
  /// a Lissajous curve in x, y and z.
  kTumble,
  kStill,  ///< a ball at rest on the optical axis
};

/// Name of a scene on the command line.
struct SceneName {
  std::string_view name;
  SceneKind kind;
};
inline constexpr std::array<SceneName, 4> kSceneNames{{{"bounce", SceneKind::kBounce},
                                                       {"approach", SceneKind::kApproach},
                                                       {"tumble", SceneKind::kTumble},
                                                       {"still", SceneKind::kStill}}};

/// State of the body in the camera frame. At the instant of an impact it is the state just after
/// the impact.
struct BodyState {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  /// Rotation of vectors from the body's frame to the camera frame.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Vec3 angular_velocity_rad_s = Vec3::Zero();  ///< constant in every scene
};

/// Change of the velocity of the body's centre at an impact, in the nominal frame.
struct SceneImpact {
  double time_s = 0.0;
  Vec3 delta_velocity_mm_s = Vec3::Zero();
};

/// Conversion of a scene from the camera frame to the nominal frame; constant.
struct SceneView {
  Workspace workspace;
  CameraModel camera;
  DepthRange range;

  /// Returns the nominal height, mm, of the depth `depth_mm`.
  [[nodiscard]] double height_mm(double depth_mm) const noexcept;
  /// Converts the motion of a point from the camera frame to the nominal frame. The result is
  /// exact, because it applies the chain rule to the projection.
  [[nodiscard]] Motion project(const Vec3& position_mm, const Vec3& velocity_mm_s,
                               const Vec3& acceleration_mm_s2) const noexcept;
};

/// The scene at one instant: shape and motion of its body.
class SceneInstant {
 public:
  /// Visible point of the body's surface, in the camera frame.
  struct Hit {
    Vec3 position_mm;
    Vec3 normal;  ///< normal that points outward; its length is not 1
  };

  /// Creates the scene with the body in the state `body`. `semi_axes_mm`: half of the ellipsoid's
  /// axes. `angle_rad`: rotation of the body about nominal +z.
  SceneInstant(const SceneView& view, const BodyState& body, const Vec3& semi_axes_mm,
               double angle_rad);

  /// Returns the first point of the body on the ray through an image point; nullopt if the ray does
  /// not hit the body.
  [[nodiscard]] std::optional<Hit> hit(const Vec2& image_px) const noexcept;
  /// Returns height (mm) and gradient (mm/mm) of the surface at a nominal point; nullopt outside
  /// the object. Towards the silhouette the gradient grows without bound.
  [[nodiscard]] std::optional<SurfaceSample> surface(const Vec2& nominal_mm) const noexcept;
  /// Returns the motion of the body's centre in the nominal frame. Its z is the height of the
  /// centre's depth. The angle is about the +z axis of that frame.
  [[nodiscard]] Motion motion() const noexcept;
  /// Returns the nominal motion of that point of the body which is visible at `nominal_mm`; nullopt
  /// outside the object.
  [[nodiscard]] std::optional<Motion> pointMotion(const Vec2& nominal_mm) const noexcept;
  /// Returns the pixels whose centres may be inside the object, clipped to the picture.
  [[nodiscard]] PixelRect boundingBox() const noexcept;
  [[nodiscard]] const BodyState& body() const noexcept { return body_; }

 private:
  SceneView view_;
  BodyState body_;
  double angle_rad_;
  Eigen::Matrix3d shape_;  // surface: (X - c)^T shape (X - c) = 1
  // A line l in normalised coordinates touches the outline if l^T dual l = 0.
  Eigen::Matrix3d dual_;
  Vec3 shape_centre_;   // shape * centre
  double centre_term_;  // c^T shape c - 1
};

/// A scene of one kind, at all times.
class SyntheticScene {
 public:
  /// Creates the scene `kind`, fitted into `workspace`, whose size must be positive. The focal
  /// length is 600 px at 640 x 480 px and grows with the picture.
  explicit SyntheticScene(SceneKind kind, const Workspace& workspace = {});

  /// Returns the scene at the time `time_s`.
  [[nodiscard]] SceneInstant at(double time_s) const;
  /// Returns all impacts within [0, duration), in order of time.
  [[nodiscard]] const std::vector<SceneImpact>& impacts() const noexcept { return impacts_; }
  /// Returns the time after which the scene repeats, s.
  [[nodiscard]] double duration_s() const noexcept;
  [[nodiscard]] const SceneView& view() const noexcept { return view_; }
  [[nodiscard]] const Vec3& semiAxes_mm() const noexcept { return semi_axes_mm_; }
  /// Returns the depth of the plane behind the body, mm. It is farther than the mapped range.
  [[nodiscard]] double background_mm() const noexcept;

 private:
  SceneKind kind_;
  SceneView view_;
  Vec3 semi_axes_mm_;
  std::vector<SceneImpact> impacts_;
};

}  // namespace hapticast::server
