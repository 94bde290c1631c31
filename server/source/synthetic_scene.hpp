// SPDX-License-Identifier: MIT
// Synthetic scenes with exact ground truth at any instant: an ellipsoid on a closed-form trajectory
// before a pinhole camera. Only mathematics; synthetic_source draws the pictures. Immutable.
// Thread: any.
// Camera frame: X right, Y down, Z forward, mm. Nominal and image frames: common/geometry.hpp.
// Time: s since the start of the clip, any finite value; scenes are periodic.
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

// Value noise in space, three octaves: the solid texture of the synthetic bodies. Thread: any.
// any.

/// A fixed noise field.
class SolidNoise {
 public:
  SolidNoise();

  /// Returns the noise at a position, 0..1 with a mean of about 0.5: smooth, the same in every run.
  /// The finest detail is about 6 mm wide; the pattern repeats every 768 mm.
  [[nodiscard]] float at(const Vec3& position_mm) const noexcept;

 private:
  std::vector<float> lattice_;
};

enum class SceneKind : std::uint8_t {
  kBounce,  ///< a ball under gravity in a plane parallel to the picture, elastic at floor and walls
  kApproach,  ///< a ball that oscillates along the optical axis
  /// An ellipsoid 1 : .7 : .8 that rotates about a tilted axis on a Lissajous curve in x, y, z.
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

/// State of the body in the camera frame. At the instant of an impact: the state just after it.
struct BodyState {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< body to camera
  Vec3 angular_velocity_rad_s = Vec3::Zero();              ///< constant in every scene
};

/// A change of the centre's velocity, in the nominal frame.
struct SceneImpact {
  double time_s = 0.0;
  Vec3 delta_velocity_mm_s = Vec3::Zero();
};

/// Constant mapping of a scene from the camera frame to nominal units.
struct SceneView {
  Workspace workspace;
  CameraModel camera;
  DepthRange range;

  /// Returns the nominal height of a depth, mm.
  [[nodiscard]] double height_mm(double depth_mm) const noexcept;
  /// Returns the nominal position, velocity and acceleration of a point that moves in the camera
  /// frame. Exact: chain rule through the projection.
  [[nodiscard]] Motion project(const Vec3& position_mm, const Vec3& velocity_mm_s,
                               const Vec3& acceleration_mm_s2) const noexcept;
};

/// The scene at one instant.
class SceneInstant {
 public:
  /// A visible point of the surface, camera frame.
  struct Hit {
    Vec3 position_mm;
    Vec3 normal;  ///< outward, not normalised
  };

  /// `angle_rad`: rotation of the body about nominal +z.
  SceneInstant(const SceneView& view, const BodyState& body, const Vec3& semi_axes_mm,
               double angle_rad);

  /// Returns the first intersection of the ray through an image point with the body; nullopt if
  /// there is none.
  [[nodiscard]] std::optional<Hit> hit(const Vec2& image_px) const noexcept;
  /// Returns height (mm) and gradient (mm/mm) at a nominal point; nullopt outside the object. The
  /// gradient diverges towards the silhouette.
  [[nodiscard]] std::optional<SurfaceSample> surface(const Vec2& nominal_mm) const noexcept;
  /// Returns the motion of the body's centre, with its depth mapped like a height; angle about
  /// nominal +z.
  [[nodiscard]] Motion motion() const noexcept;
  /// Returns the motion of the material point visible at a nominal point; nullopt outside the
  /// object.
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

/// A scene of one kind.
class SyntheticScene {
 public:
  /// Requires a workspace with a positive size. The focal length is 600 px at 640 x 480 px and
  /// scales with the picture.
  explicit SyntheticScene(SceneKind kind, const Workspace& workspace = {});

  /// Returns the scene at `time_s`.
  [[nodiscard]] SceneInstant at(double time_s) const;
  /// Returns all impacts within [0, duration), in order of time.
  [[nodiscard]] const std::vector<SceneImpact>& impacts() const noexcept { return impacts_; }
  /// Returns the period of the scene, s.
  [[nodiscard]] double duration_s() const noexcept;
  [[nodiscard]] const SceneView& view() const noexcept { return view_; }
  [[nodiscard]] const Vec3& semiAxes_mm() const noexcept { return semi_axes_mm_; }
  /// Depth of the plane behind the body, beyond far.
  [[nodiscard]] double background_mm() const noexcept;

 private:
  SceneKind kind_;
  SceneView view_;
  Vec3 semi_axes_mm_;
  std::vector<SceneImpact> impacts_;
};

}  // namespace hapticast::server
