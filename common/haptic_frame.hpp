// SPDX-License-Identifier: MIT
// Haptic descriptor of one video frame: the touchable surfaces and their motion. Plain values,
// validated by the decoder (common/protocol). Units: nominal mm, mm/s, mm/s², rad
// (common/geometry.hpp). Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast {

inline constexpr std::size_t kMaxObjects = 16;  ///< objects and layers in one frame
inline constexpr std::size_t kMaxImpacts = 4;   ///< impacts of an object in one frame
inline constexpr int kMaxWidth_px = 1920;
inline constexpr int kMaxHeight_px = 1080;
/// Limit of the summed rectangles of all reliefs of a frame; bounds a receiver's preparation.
inline constexpr std::size_t kMaxReliefPixels = std::size_t{2} * 1920 * 1080;
inline constexpr int kGridCell_px = 16;  ///< cell of a MotionGrid
/// Returns the cells of a MotionGrid along `px` pixels; the last cell may extend beyond them.
template <class Integer>
constexpr Integer gridCells(Integer px) {
  return (px + Integer{kGridCell_px} - 1) / Integer{kGridCell_px};
}

/// Heights over a rectangle of the image, valid inside the mask.
struct Relief {
  PixelRect rect;                  ///< inside the picture
  std::vector<float> height_mm;    ///< row-major, rect.width * rect.height; 0..Workspace::depth_mm
  std::vector<std::uint8_t> mask;  ///< same shape; 1 inside the object, 0 outside
  bool operator==(const Relief&) const = default;

  /// Returns a relief entirely outside its mask, at height 0.
  static Relief blank(const PixelRect& rect) {
    return {rect, std::vector<float>(rect.pixels()), std::vector<std::uint8_t>(rect.pixels())};
  }
};

/// Residual velocity and acceleration of the surface, relative to the object's own motion. In the
/// thesis's method: the difference of its dense flow. Covers the relief's rectangle in cells of
/// kGridCell_px, row by row.
struct MotionGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Eigen::Vector3f> velocity_mm_s;
  std::vector<Eigen::Vector3f> acceleration_mm_s2;
};

/// Meaning of `Motion::position_mm`.
enum class ReferencePoint : std::uint8_t {
  kUnknown = 0,
  kCentreOfMass = 1,     ///< estimated centre of the body
  kVisibleCentroid = 2,  ///< centroid of the visible surface
};

/// Motion of an object at its reference point.
struct Motion {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;  ///< about +z through the reference point, right-handed
  double angular_velocity_rad_s = 0.0;
  ReferencePoint reference_point = ReferencePoint::kUnknown;
  double quality = 1.0;           ///< 0 (lost, predicted) .. 1 (measured well)
  double visible_fraction = 1.0;  ///< share of the object, 0..1
};

/// A bounce: the object's velocity changes by `delta_velocity_mm_s` at `time`.
struct Impact {
  MediaTime time;
  Vec3 delta_velocity_mm_s = Vec3::Zero();
};

/// The author's material of the surface; no value is negative. For absent values the viewer chooses
/// (client/haptics/contact/surface_model.hpp).
struct Material {
  std::optional<double> stiffness_N_mm;
  std::optional<double> damping_Ns_m;
  std::optional<double> static_friction;
  std::optional<double> dynamic_friction;
  std::optional<double> texture_K_mm;  ///< K of Eq. 3, in mm
  bool operator==(const Material&) const = default;
};

/// One object of a frame. Its heights are a `Shape`: Relief for production and contact, CodedRelief
/// (common/codec/coded_frame.hpp) for transport.
template <class Shape>
struct ObjectOf {
  std::uint32_t id = 0;                 ///< an object found again has a new one
  std::uint32_t layer = 0;              ///< 0 = nearest
  std::uint64_t changed_in_frame = 0;   ///< id of the frame of the last change of `relief`
  std::shared_ptr<const Shape> relief;  ///< null: unchanged since `changed_in_frame`
  Motion motion;
  std::shared_ptr<const MotionGrid> grid;  ///< null: the rigid motion explains it
  std::vector<Impact> impacts;             ///< at most kMaxImpacts, around this frame
  Material material;
};

/// One frame with all its objects.
template <class Shape>
struct FrameOf {
  /// Changes at a cut, a seek, a loop's wrap with motion, a change of range.
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;                  ///< increases without reuse over the server's life
  MediaTime media_time;                  ///< capture time
  std::vector<ObjectOf<Shape>> objects;  ///< at most kMaxObjects
};

/// Key of an object across frames: its id and layer.
using ObjectKey = std::pair<std::uint32_t, std::uint32_t>;
template <class Shape>
ObjectKey makeKey(const ObjectOf<Shape>& object) {
  return {object.id, object.layer};
}

using HapticObject = ObjectOf<Relief>;
using HapticFrame = FrameOf<Relief>;

/// Picture of the same instant, for the viewer's window.
struct VideoFrame {
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;  ///< id of the HapticFrame of the same instant
  MediaTime media_time;
  std::vector<std::uint8_t> jpeg;
};

/// Algorithms of all stages: hapticast's or the thesis's.
enum class Method : std::uint8_t { kHapticast = 0, kThesis = 1 };

/// Announcement of a stream before its first frame.
struct StreamDescription {
  std::string name;     ///< name of the source, for people
  double fps = 25.0;    ///< 1..240
  Workspace workspace;  ///< includes the picture's size in px
  Method method = Method::kHapticast;
  Duration pipeline_latency{0};             ///< frames are complete this long after capture
  double largest_acceleration_mm_s2 = 0.0;  ///< of the clip; live: a running bound; 0: unknown
  std::optional<double> mass_kg;            ///< the author's mass of the object
  bool operator==(const StreamDescription&) const = default;
};

}  // namespace hapticast
