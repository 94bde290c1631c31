// SPDX-License-Identifier: MIT
// Frames of a haptic video: what can be touched at one instant, and how it moves. Stream, Vision
// and Source make frames. Renderer and Publisher read them.
//
// Contract
// - Nominal frame. The origin is the centre of the picture on the plane of height 0. x points to
//   the right, y up, z towards the viewer; all are in mm. The picture fits into width_mm x
//   height_mm with one scale for both axes.
// - Picture. Pixel (u, v) is column u and row v; (0, 0) is at the top left. Images are row-major.
// - Heights are those of the frame's own time and place: z of the surface in the nominal frame. An
//   object that has moved has another HeightMap. position_mm is its reference point in that frame,
//   and the renderer moves the surface by position and velocity between frames.
// - Times are in s of the media clock, the clock of the frames of one stream.
// - Sharing. Frames of one object share its heights as long as the heights do not change.
// - Errors. All functions of the library throw std::invalid_argument for a wrong argument and
//   std::runtime_error for all other failures. what() is one line with the cause and the remedy.
// - Threads. These are plain values: any thread, one at a time.
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

/// Heights of an object over a rectangle of the picture. A height is valid where the mask is 1.
struct HeightMap {
  int left_px = 0;                 ///< column of the rectangle's first pixel in the picture
  int top_px = 0;                  ///< row of the rectangle's first pixel in the picture
  int width_px = 0;                ///< 1..1920
  int height_px = 0;               ///< 1..1080
  std::vector<float> height_mm;    ///< height_px x width_px; 0..StreamInfo::depth_mm
  std::vector<std::uint8_t> mask;  ///< same shape; 1: the pixel belongs to the object

  HeightMap() = default;
  /// Makes a rectangle without pixels of the object. Requires sizes of at least 0.
  HeightMap(int left, int top, int width, int height)
      : left_px(left),
        top_px(top),
        width_px(width),
        height_px(height),
        height_mm(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
        mask(height_mm.size()) {}
  /// Sets the height of a pixel of the object. `u` and `v` count from the rectangle's corner.
  /// Requires 0 <= u < width_px and 0 <= v < height_px.
  void set(int u, int v, float height) {
    const auto at = static_cast<std::size_t>(v) * static_cast<std::size_t>(width_px) +
                    static_cast<std::size_t>(u);
    height_mm[at] = height;
    mask[at] = 1;
  }
};

/// An object that can be touched, at one instant.
struct Object {
  /// A bounce: the velocity changes by `delta_velocity_mm_s` at `time_s`.
  struct Impact {
    double time_s = 0.0;
    Eigen::Vector3d delta_velocity_mm_s = Eigen::Vector3d::Zero();
  };
  /// The author's material. No value is negative. Absent: the viewer's default.
  struct Material {
    std::optional<double> stiffness_N_mm = {};
    std::optional<double> damping_Ns_m = {};
    std::optional<double> static_friction = {};
    std::optional<double> dynamic_friction = {};
    std::optional<double> texture_K_mm = {};  ///< K of the perturbed surface model, mm
    std::optional<double> mass_kg = {};
  };
  /// Motion of the surface relative to the object's own motion, in square cells of 16 px over the
  /// rectangle of the heights, row by row.
  struct CellMotion {
    int columns = 0;  ///< width_px / 16, rounded up
    int rows = 0;     ///< height_px / 16, rounded up
    std::vector<Eigen::Vector3f> velocity_mm_s = {};
    std::vector<Eigen::Vector3f> acceleration_mm_s2 = {};
  };

  std::uint32_t id = 1;                      ///< the same in all frames of this object
  std::uint32_t layer = 0;                   ///< 0: nearest to the viewer .. 15
  std::shared_ptr<const HeightMap> heights;  ///< null: nothing to touch
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mm_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_mm_s2 = Eigen::Vector3d::Zero();
  double angle_rad = 0.0;  ///< about +z through position_mm, right-handed
  double angular_velocity_rad_s = 0.0;
  double quality = 1.0;           ///< 0 (lost: the motion is a prediction) .. 1 (measured well)
  double visible_fraction = 1.0;  ///< visible share of the object, 0..1
  std::shared_ptr<const CellMotion> cells;  ///< null: position and velocity explain all motion
  std::vector<Impact> impacts = {};         ///< at most 4
  Material material = {};
};

/// All objects at one instant.
struct Frame {
  std::uint64_t id = 0;     ///< rises from frame to frame; Publisher sets it
  std::uint32_t epoch = 0;  ///< another value: nothing continues the frame before (a cut, a seek)
  double time_s = 0.0;      ///< time of the capture
  std::vector<Object> objects;     ///< at most 16
  std::vector<std::uint8_t> jpeg;  ///< picture of the frame; empty: none
};

/// Properties of a stream.
struct StreamInfo {
  std::string name = {};    ///< name of the content, for people
  double fps = 25.0;        ///< frames/s, 1..240
  int width_px = 640;       ///< of the picture, 1..1920
  int height_px = 480;      ///< of the picture, 1..1080
  double width_mm = 160.0;  ///< size of the nominal frame
  double height_mm = 120.0;
  double depth_mm = 30.0;                ///< largest height
  bool thesis = false;                   ///< true: the server uses the methods of the thesis
  bool stretch = false;                  ///< true: each axis of the picture has its own scale
  double latency_s = 0.0;                ///< time from a capture until its frame is complete
  double most_acceleration_mm_s2 = 0.0;  ///< largest one of the content; 0: unknown
  std::optional<double> mass_kg = {};    ///< mass of the object by its author
};

}  // namespace hapticast
