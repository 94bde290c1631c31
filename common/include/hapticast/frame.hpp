// SPDX-License-Identifier: MIT
// Frames of a haptic video: what can be touched at one instant, and how it moves. Stream, Vision
// and Source make frames. Renderer and Publisher read them.
//
// Contract
// - Nominal frame. The origin is the centre of the picture on the plane of height 0. x points to
//   the right, y up, z towards the viewer; all are in mm. The picture fits into width_mm x
//   height_mm with one scale for both axes, unless StreamInfo::stretch is true.
// - Picture. Pixel (u, v) is column u and row v; (0, 0) is at the top left. Images are row-major.
// - Heights are the z of the surface in the nominal frame at the time of their frame. An object
//   that has moved needs another HeightMap. position_mm does not shift the heights: only its change
//   from frame to frame, with the velocity, moves the surface between the frames.
// - Times are in s of the media clock, the clock of the frames of one stream.
// - Sharing. Two frames share one HeightMap (the same pointer) if the heights have not changed. Do
//   not change a HeightMap after you have passed its frame to a function.
// - Thesis. The methods of Dindar, "Dynamic Force Rendering Due to the Relative Motion in Haptic
//   Video", can replace those of hapticast, for comparisons.
// - Errors. A function throws std::invalid_argument for an argument outside its contract, and
//   std::runtime_error for failures from outside (network, files, received bytes). what() is one
//   line with the cause and the remedy. Exceptions to this rule are stated at the function.
// - Threads. These types are plain values: any thread, one at a time.
// - Versions. There is no stable binary interface yet: compile against the installed version.
//
// Example: a disc of 20 mm height in the middle of the picture.
//
//   hapticast::Frame frame;
//   auto& disc = frame.objects.emplace_back();
//   auto heights = std::make_shared<hapticast::HeightMap>(270, 190, 100, 100);
//   for (int v = 0; v < 100; ++v)
//     for (int u = 0; u < 100; ++u)
//       if (std::hypot(u - 49.5, v - 49.5) < 45.0) heights->set(u, v, 20.0F);
//   disc.heights = heights;
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hapticast {

/// Heights of an object over a rectangle of the picture. A height is valid where the mask is 1. The
/// rectangle lies inside the picture and has at least one pixel.
struct HeightMap {
  int left_px = 0;                 ///< column of the rectangle's first pixel in the picture
  int top_px = 0;                  ///< row of the rectangle's first pixel in the picture
  int width_px = 0;                ///< columns of the rectangle, 1..1920
  int height_px = 0;               ///< rows of the rectangle, 1..1080
  std::vector<float> height_mm;    ///< height_px x width_px; 0..StreamInfo::depth_mm
  std::vector<std::uint8_t> mask;  ///< same shape; 1: the pixel belongs to the object

  HeightMap() = default;
  /// Makes a rectangle without pixels of the object. Requires sizes of at least 1.
  HeightMap(int left, int top, int width, int height)
      : left_px(left),
        top_px(top),
        width_px(width),
        height_px(height),
        height_mm(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
        mask(height_mm.size()) {}
  /// Adds pixel (u, v) to the object, with its height in mm. `u` and `v` count from the corner of
  /// the rectangle. Requires 0 <= u < width_px and 0 <= v < height_px, which it does not check.
  void set(int u, int v, float height) {
    const auto at = static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) +
                    static_cast<std::size_t>(u);
    height_mm[at] = height;
    mask[at] = 1;
  }
};

/// An object that can be touched, at one instant.
struct Object {
  /// A bounce: at the time `time_s` the velocity of the object changes by `delta_velocity_mm_s`.
  struct Impact {
    double time_s = 0.0;
    Eigen::Vector3d delta_velocity_mm_s = Eigen::Vector3d::Zero();
  };
  /// The author's material. Each value is 0 or more. Absent: the viewer uses its own default.
  struct Material {
    std::optional<double> stiffness_N_mm = {};    ///< at most 1000
    std::optional<double> damping_Ns_m = {};      ///< at most 1000
    std::optional<double> static_friction = {};   ///< coefficient of a hand at rest, at most 1.5
    std::optional<double> dynamic_friction = {};  ///< coefficient of a sliding hand, at most 1.5
    std::optional<double> texture_K_mm = {};      ///< K of Eq. 3 of the thesis, at most 1000
    std::optional<double> mass_kg = {};           ///< mass of this object, 1e-6..1000
  };
  /// Motion of the surface relative to the motion of the object, in square cells of 16 px. The
  /// cells cover the rectangle of the heights, row by row. Both vectors have columns x rows values.
  struct CellMotion {
    int columns = 0;  ///< width_px / 16, rounded up
    int rows = 0;     ///< height_px / 16, rounded up
    std::vector<Eigen::Vector3f> velocity_mm_s;
    std::vector<Eigen::Vector3f> acceleration_mm_s2;
  };

  /// Number of the object, 1 or more: the same in all frames. Two objects of a frame differ in id
  /// or layer.
  std::uint32_t id = 1;
  /// An object with steps of depth becomes several Objects with one id. `layer` numbers them from 0
  /// (nearest) to 15.
  std::uint32_t layer = 0;
  /// Null: the object cannot be touched. A Stream repeats the last heights of an object whose
  /// heights have not changed.
  std::shared_ptr<const HeightMap> heights;
  /// Position, velocity and acceleration of the reference point, such as the centre of mass.
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mm_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_mm_s2 = Eigen::Vector3d::Zero();
  double angle_rad = 0.0;  ///< about +z through position_mm, right-handed
  double angular_velocity_rad_s = 0.0;
  /// Quality of the motion, 0..1. At 0 the object is lost, and viewers let it rest. Other values
  /// are information.
  double quality = 1.0;
  double visible_fraction = 1.0;            ///< visible share of the object, 0..1
  std::shared_ptr<const CellMotion> cells;  ///< null: the surface moves as a rigid body
  /// Impacts near the time of the frame, before or after it, at most 4. A viewer renders each
  /// impact once, although several frames repeat it.
  std::vector<Impact> impacts;
  Material material;
};

/// All objects at one instant.
struct Frame {
  std::uint64_t id = 0;  ///< number of a received frame; Renderer and Publisher ignore it
  /// Number of the continuous part. A frame with another epoch continues nothing of the frame
  /// before (a cut, a seek). The times rise across epochs, too.
  std::uint32_t epoch = 0;
  double time_s = 0.0;             ///< time of the capture
  std::vector<Object> objects;     ///< at most 16
  std::vector<std::uint8_t> jpeg;  ///< picture of the frame; empty: none
};

/// Properties of a stream.
struct StreamInfo {
  std::string name = {};     ///< name of the content for people, UTF-8, at most 256 bytes
  double fps = 25.0;         ///< frames/s, 1..240
  int width_px = 640;        ///< width of the picture, 1..1920
  int height_px = 480;       ///< height of the picture, 1..1080
  double width_mm = 160.0;   ///< width of the nominal frame, 0.001..1000
  double height_mm = 120.0;  ///< height of the nominal frame, 0.001..1000
  double depth_mm = 30.0;    ///< largest height of a surface, 0.001..1000
  bool thesis = false;       ///< true: the source used the methods of the thesis; information only
  bool stretch = false;      ///< true: each axis of the picture has its own scale
  /// Time from the capture of a frame until it is published, 0..10. Viewers wait so much longer.
  double latency_s = 0.0;
  /// Largest acceleration of the content, 0..1e8. Viewers limit larger ones to it. 0: unknown.
  double max_acceleration_mm_s2 = 0.0;
  /// Mass of each object that has no Material::mass_kg, 1e-6..1000. Absent: the viewer's own
  /// choice.
  std::optional<double> mass_kg = {};
};

}  // namespace hapticast
