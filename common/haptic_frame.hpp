// SPDX-License-Identifier: MIT
// Haptic descriptor of one video frame: the touchable surfaces and their motion. All types are
// plain structs. The decoder (common/protocol) checks their values when they arrive. Units: nominal
// mm, mm/s, mm/s², rad (common/geometry.hpp). Thread: any.
#pragma once

#include <algorithm>
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

/// Largest number of objects and layers in one frame.
inline constexpr std::size_t kMaxObjects = 16;
/// Largest number of impacts of an object in one frame.
inline constexpr std::size_t kMaxImpacts = 4;
inline constexpr int kMaxWidth_px = 1920;
inline constexpr int kMaxHeight_px = 1080;
/// Largest number of pixels of all reliefs of a frame, summed over their rectangles. It bounds the
/// work of a receiver.
inline constexpr std::size_t kMaxReliefPixels = std::size_t{2} * 1920 * 1080;
inline constexpr int kGridCell_px = 16;  ///< side of a cell of a MotionGrid
/// Returns the number of cells of a MotionGrid along `px` pixels. The last cell may extend beyond
/// them.
template <class Integer>
constexpr Integer gridCells(Integer px) {
  return (px + Integer{kGridCell_px} - 1) / Integer{kGridCell_px};
}

/// Heights of an object over a rectangle of the picture. They are valid inside the mask.
struct Relief {
  PixelRect rect;                  ///< inside the picture
  std::vector<float> height_mm;    ///< row-major, rect.width * rect.height; 0..Workspace::depth_mm
  std::vector<std::uint8_t> mask;  ///< same shape; 1 inside the object, 0 outside
  bool operator==(const Relief&) const = default;

  /// Returns a relief with an empty mask and heights of 0.
  static Relief blank(const PixelRect& rect) {
    return {rect, std::vector<float>(rect.pixels()), std::vector<std::uint8_t>(rect.pixels())};
  }
};

/// Motion of the surface relative to the object's own motion: velocity and acceleration of each
/// cell. In the thesis's method it is the difference between the dense optical flow and the
/// object's motion. A cell is a square with sides of kGridCell_px. The cells cover the relief's
/// rectangle, row by row.
struct MotionGrid {
  int columns = 0;
  int rows = 0;
  std::vector<Eigen::Vector3f> velocity_mm_s;
  std::vector<Eigen::Vector3f> acceleration_mm_s2;
  bool operator==(const MotionGrid&) const = default;
};

/// Point of the object that `Motion::position_mm` describes.
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
  double angle_rad = 0.0;  ///< angle about +z through the reference point, right-handed
  double angular_velocity_rad_s = 0.0;
  ReferencePoint reference_point = ReferencePoint::kUnknown;
  double quality = 1.0;           ///< 0 (lost, so the motion is predicted) to 1 (measured well)
  double visible_fraction = 1.0;  ///< visible share of the object, 0..1
  bool operator==(const Motion&) const = default;
};

/// A bounce: the object's velocity changes by `delta_velocity_mm_s` at `time`.
struct Impact {
  MediaTime time;
  Vec3 delta_velocity_mm_s = Vec3::Zero();
  bool operator==(const Impact&) const = default;
};

/// The author's material of an object. No value is negative. For absent values the viewer uses
/// its own defaults (client/haptics/contact/surface_model.hpp).
struct Material {
  std::optional<double> stiffness_N_mm;
  std::optional<double> damping_Ns_m;
  std::optional<double> static_friction;
  std::optional<double> dynamic_friction;
  std::optional<double> texture_K_mm;  ///< K of Eq. 3, in mm
  std::optional<double> mass_kg;       ///< mass of this object, instead of the stream's
  bool operator==(const Material&) const = default;
};

/// One object of a frame. `Shape` is the type of its relief. The server's vision and the client's
/// haptic loop use Relief. The transport uses CodedRelief (common/codec/coded_frame.hpp).
template <class Shape>
struct ObjectOf {
  std::uint32_t id = 0;                 ///< an object that was lost and found again has a new id
  std::uint32_t layer = 0;              ///< 0 = nearest
  std::uint64_t changed_in_frame = 0;   ///< id of the frame in which `relief` changed last
  std::shared_ptr<const Shape> relief;  ///< null if it did not change since that frame
  Motion motion;
  /// Null if `motion` alone explains the motion of the surface.
  std::shared_ptr<const MotionGrid> grid;
  std::vector<Impact> impacts;  ///< at most kMaxImpacts, near the time of this frame
  Material material;
};

/// One frame with all its objects.
template <class Shape>
struct FrameOf {
  /// The epoch changes at a cut, a seek, a change of the mapped range, and when a clip with motion
  /// starts again.
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;  ///< increases during the server's run, and is never used twice
  MediaTime media_time;  ///< capture time
  std::vector<ObjectOf<Shape>> objects;  ///< at most kMaxObjects
};

/// Key that identifies an object across frames: its id and layer.
using ObjectKey = std::pair<std::uint32_t, std::uint32_t>;
template <class Shape>
ObjectKey makeKey(const ObjectOf<Shape>& object) {
  return {object.id, object.layer};
}

using HapticObject = ObjectOf<Relief>;
using HapticFrame = FrameOf<Relief>;

/// Picture of a frame for the viewer's window.
struct VideoFrame {
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;  ///< id of the HapticFrame of the same instant
  MediaTime media_time;
  std::vector<std::uint8_t> jpeg;
};

/// Set of algorithms that a program uses: those of hapticast, or those of the thesis.
enum class Method : std::uint8_t { kHapticast = 0, kThesis = 1 };

/// Place in a recording, of a viewer with a time line of its own (--on-demand).
struct Timeline {
  double length_s = 0.0;    ///< length of the recording, 0..1e6
  double position_s = 0.0;  ///< place at the media time `at`, 0..length_s
  MediaTime at;
  double speed = 1.0;  ///< recorded seconds in a second; 0: paused, or at the end
  bool operator==(const Timeline&) const = default;

  /// Returns the place in the recording at a media time, s.
  [[nodiscard]] double computePosition_s(MediaTime time) const {
    return std::clamp(position_s + speed * toSeconds(time - at), 0.0, length_s);
  }
};

/// Description of a stream. A server sends it before the first frame.
struct StreamDescription {
  std::string name;     ///< name of the source, for people
  double fps = 25.0;    ///< 1..240
  Workspace workspace;  ///< includes the picture's size in px
  Method method = Method::kHapticast;
  Duration pipeline_latency{0};  ///< time from the capture of a frame until it is complete
  /// Largest acceleration in the whole clip, or in a live source so far. 0 means unknown.
  double largest_acceleration_mm_s2 = 0.0;
  std::optional<double> mass_kg;  ///< mass of the object by its author
  /// Present if the viewer may pause, seek, and set the speed, for itself alone.
  std::optional<Timeline> timeline;
  bool operator==(const StreamDescription&) const = default;
};

}  // namespace hapticast
