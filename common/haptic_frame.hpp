// SPDX-License-Identifier: MIT
// The descriptor: what can be touched in one video frame, and how it moves. Plain values; validated
// where they are read from bytes (common/wire). Units: nominal mm, mm/s, mm/s², rad
// (common/geometry.hpp).
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
inline constexpr std::size_t kMaxImpacts = 4;   ///< impacts an object carries in one frame
inline constexpr int kMaxWidth_px = 1920;
inline constexpr int kMaxHeight_px = 1080;
/// Summed rectangles of all reliefs of a frame: bounds what a receiver has to prepare.
inline constexpr std::size_t kMaxReliefPixels = std::size_t{2} * 1920 * 1080;
inline constexpr int kGridCell_px = 16;  ///< cell of a MotionGrid
/// Cells of a MotionGrid along so many pixels; the last one may reach beyond them.
template <class Integer>
constexpr Integer gridCells(Integer px) {
  return (px + Integer{kGridCell_px} - 1) / Integer{kGridCell_px};
}

/// Heights over a rectangle of the image, valid where the mask says so.
struct Relief {
  PixelRect rect;                  ///< inside the picture
  std::vector<float> height_mm;    ///< row-major, rect.width * rect.height; 0..Workspace::depth_mm
  std::vector<std::uint8_t> mask;  ///< same shape; 1 inside the object, 0 outside
  bool operator==(const Relief&) const = default;

  /// All of it outside, at height 0.
  static Relief blank(const PixelRect& rect) {
    return {rect, std::vector<float>(rect.pixels()), std::vector<std::uint8_t>(rect.pixels())};
  }
};

/// Velocity and acceleration of the surface that the object's own motion does not explain (in the
/// thesis's method: by which its dense flow differs), over the relief's rectangle in cells of
/// kGridCell_px, row-major.
struct MotionGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Eigen::Vector3f> velocity_mm_s;
  std::vector<Eigen::Vector3f> acceleration_mm_s2;
};

/// Which point of the object `Motion::position_mm` is.
enum class ReferencePoint : std::uint8_t {
  kUnknown = 0,
  kCentreOfMass = 1,     ///< estimated centre of the body
  kVisibleCentroid = 2,  ///< centroid of the visible surface
};

struct Motion {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;  ///< about +z through the reference point, right-handed
  double angular_velocity_rad_s = 0.0;
  ReferencePoint reference_point = ReferencePoint::kUnknown;
  double quality = 1.0;           ///< 0 (lost, predicted) .. 1 (measured well)
  double visible_fraction = 1.0;  ///< 0..1
};

/// A bounce: the object's velocity changes by `delta_velocity` at `time`.
struct Impact {
  MediaTime time;
  Vec3 delta_velocity_mm_s = Vec3::Zero();
};

/// What the author says of the surface, none of it negative. What is absent is the viewer's choice
/// (client/haptics/contact/surface_model.hpp).
struct Material {
  std::optional<double> stiffness_N_mm;
  std::optional<double> damping_Ns_m;
  std::optional<double> static_friction;
  std::optional<double> dynamic_friction;
  std::optional<double> texture_K_mm;  ///< K of Eq. 3, in mm
  bool operator==(const Material&) const = default;
};

/// One object of a frame, whose heights are a `Shape`: Relief where they are made and felt,
/// CodedRelief (common/codec/coded_frame.hpp) where they travel.
template <class Shape>
struct ObjectOf {
  std::uint32_t id = 0;                 ///< a re-found object gets a new one
  std::uint32_t layer = 0;              ///< 0 = nearest
  std::uint64_t changed_in_frame = 0;   ///< frame id in which `relief` last changed
  std::shared_ptr<const Shape> relief;  ///< null: unchanged since `changed_in_frame`
  Motion motion;
  std::shared_ptr<const MotionGrid> grid;  ///< null: the rigid motion explains it
  std::vector<Impact> impacts;             ///< at most kMaxImpacts, of the frames around
  Material material;
};

template <class Shape>
struct FrameOf {
  std::uint32_t epoch = 0;               ///< new at every cut, seek, wrap that moves, range change
  std::uint64_t id = 0;                  ///< counts up without reuse over the server's life
  MediaTime media_time;                  ///< capture time
  std::vector<ObjectOf<Shape>> objects;  ///< at most kMaxObjects
};

/// What an object is known by from frame to frame: its id and layer.
using ObjectKey = std::pair<std::uint32_t, std::uint32_t>;
template <class Shape>
ObjectKey makeKey(const ObjectOf<Shape>& object) {
  return {object.id, object.layer};
}

using HapticObject = ObjectOf<Relief>;
using HapticFrame = FrameOf<Relief>;

/// The picture of the same instant, for the viewer's window.
struct VideoFrame {
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;  ///< of the HapticFrame of the same instant
  MediaTime media_time;
  std::vector<std::uint8_t> jpeg;
};

/// Which choice of every stage: ours or the thesis's.
enum class Method : std::uint8_t { kHapticast = 0, kThesis = 1 };

/// What the server announces before the first frame.
struct StreamDescription {
  std::string name;     ///< for people: the source
  double fps = 25.0;    ///< 1..240
  Workspace workspace;  ///< holds the picture's size in px
  Method method = Method::kHapticast;
  Duration pipeline_latency{0};             ///< media time is complete this long after capture
  double largest_acceleration_mm_s2 = 0.0;  ///< of the clip; live: a running bound; 0: unknown
  std::optional<double> mass_kg;            ///< the author's mass of the object
  bool operator==(const StreamDescription&) const = default;
};

}  // namespace hapticast
