// SPDX-License-Identifier: MIT
// Synthetic scenes with exact truth at any instant: an ellipsoid moved by closed formulas before a
// pinhole camera. Only mathematics, no pictures (synthetic_source draws them). Immutable values;
// thread: any.
//
// Camera frame: X right, Y down, Z forward, mm. Nominal and image frames: common/geometry.hpp.
// Time: s since the start of the clip, any finite value; a scene repeats itself after its duration.
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

enum class SceneKind : std::uint8_t {
  kBounce,  ///< a ball under gravity in a plane parallel to the picture, elastic at floor and walls
  kApproach,  ///< a ball to and fro along the optical axis
  kTumble,  ///< an ellipsoid 1 : .7 : .8 that turns about a tilted axis on a Lissajous curve in x,
            ///< y, z
  kStill,   ///< a ball at rest on the optical axis
};

struct SceneName {
  std::string_view name;
  SceneKind kind;
};
inline constexpr std::array<SceneName, 4> kSceneNames{{{"bounce", SceneKind::kBounce},
                                                       {"approach", SceneKind::kApproach},
                                                       {"tumble", SceneKind::kTumble},
                                                       {"still", SceneKind::kStill}}};

/// The body in the camera frame. At the instant of an impact: the state just after it.
struct BodyState {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< body to camera
  Vec3 angular_velocity_rad_s = Vec3::Zero();              ///< constant in every scene
};

/// A jump of the centre's velocity, in the nominal frame.
struct SceneImpact {
  double time_s = 0.0;
  Vec3 delta_velocity_mm_s = Vec3::Zero();
};

/// What a scene maps through: fixed for the clip.
struct SceneView {
  Workspace workspace;
  CameraModel camera;
  DepthRange range;

  /// Nominal height of a depth.
  [[nodiscard]] double height_mm(double depth_mm) const noexcept;
  /// Nominal position, velocity and acceleration of a point that moves in the camera frame; exact,
  /// by the chain rule through the projection.
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

  SceneInstant(const SceneView& view, const BodyState& body, const Vec3& semi_axes_mm,
               double angle_rad);

  /// Where the ray through an image point meets the body first; nullopt beside it.
  [[nodiscard]] std::optional<Hit> hit(const Vec2& image_px) const noexcept;
  /// Height (mm) and gradient (mm/mm) at a nominal point; nullopt outside the object. The gradient
  /// grows without bound towards the silhouette.
  [[nodiscard]] std::optional<SurfaceSample> surface(const Vec2& nominal_mm) const noexcept;
  /// Motion of the body's centre, with its depth mapped like a height; angle about nominal +z.
  [[nodiscard]] Motion motion() const noexcept;
  /// Motion of the material point that is visible at a nominal point; nullopt outside the object.
  [[nodiscard]] std::optional<Motion> pointMotion(const Vec2& nominal_mm) const noexcept;
  /// The pixels whose centres can be inside the object, cut to the picture.
  [[nodiscard]] PixelRect boundingBox() const noexcept;
  [[nodiscard]] const BodyState& body() const noexcept { return body_; }

 private:
  SceneView view_;
  BodyState body_;
  double angle_rad_;
  Eigen::Matrix3d shape_;  // the surface is (X - c)^T shape (X - c) = 1
  Eigen::Matrix3d dual_;   // normalised rays' lines l touch the outline where l^T dual l = 0
  Vec3 shape_centre_;      // shape * centre
  double centre_term_;     // c^T shape c - 1
};

class SyntheticScene {
 public:
  /// Requires a workspace with a positive size. The focal length is 600 px at 640 x 480 and scales
  /// with the picture.
  explicit SyntheticScene(SceneKind kind, const Workspace& workspace = {});

  [[nodiscard]] SceneInstant at(double time_s) const;
  /// All impacts within [0, duration), in order of time.
  [[nodiscard]] const std::vector<SceneImpact>& impacts() const noexcept { return impacts_; }
  /// After this time the scene repeats itself exactly.
  [[nodiscard]] double duration_s() const noexcept;
  [[nodiscard]] const SceneView& view() const noexcept { return view_; }
  [[nodiscard]] const Vec3& semiAxes_mm() const noexcept { return semi_axes_mm_; }
  [[nodiscard]] double background_mm() const noexcept;  ///< depth of the plane behind, beyond far

 private:
  SceneKind kind_;
  SceneView view_;
  Vec3 semi_axes_mm_;
  std::vector<SceneImpact> impacts_;
};

}  // namespace hapticast::server
