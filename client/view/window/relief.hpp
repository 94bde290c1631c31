// SPDX-License-Identifier: MIT
// Reliefs in the window, if the user requests them. The painter draws them as outlines and as a
// shade over the picture. ImGui draws them as a shape in space beside the HIP, which the user can
// rotate.
// Thread: onFrame() any, everything else main.
#pragma once

#include <imgui.h>

#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/view/painter.hpp"
#include "client/view/relief_shape.hpp"
#include "client/view/window/relief_box.hpp"

namespace hapticast::client {

/// How the window shows the relief. One key selects the next display in turn.
enum class ReliefLook : std::uint8_t { kNone, kShaded, kInSpace };

/// The reliefs of the rendered frame.
class WindowRelief {
 public:
  /// Largest number of stored frames. The frame pool has the same number of slots, so the reliefs
  /// of older frames may no longer exist.
  static constexpr std::size_t kMostFrames = 32;

  /// Stores a frame, which has weak references to its reliefs.
  void onFrame(const PlayableReliefs& frame);
  /// Selects the frame at this play time for the drawing functions. While play time is paused, the
  /// selection does not change.
  void update(MediaTime play_time, const Workspace& workspace);
  /// Rotates the shape in space after the user has dragged it by this many px.
  void rotate(float right_px, float down_px);

  /// Draw the reliefs into `image` (CV_8UC3) with the picture at `place`.
  void drawOutline(cv::Mat& image, const ScenePlace& place);
  void drawShaded(cv::Mat& image, const ScenePlace& place);
  /// Draws the shape in space, inside the rectangle of box(), with the HIP and the force of
  /// `report`.
  void drawInSpace(ImDrawList& list, const ScenePlace& place, const TickReport& report);
  /// Returns the box for the shape in space.
  [[nodiscard]] ReliefBox& box() { return box_; }
  [[nodiscard]] const ReliefBox& box() const { return box_; }

 private:
  const ReliefMesh& mesh(const ScenePlace& place);
  /// Returns the mesh without walls, for the shape in space.
  const ReliefMesh& cutMesh(const ScenePlace& place);

  std::mutex mutex_;
  std::deque<PlayableReliefs> frames_;  // guarded by mutex_
  std::optional<MediaTime> shown_;
  Reliefs reliefs_;  // of the selected frame
  Workspace workspace_;
  // Built from reliefs_ on demand:
  std::optional<ReliefMesh> mesh_;
  std::optional<ReliefMesh> cut_mesh_;  // of mesh_
  int cell_px_ = 0;                     // smallest cell of mesh_
  std::optional<std::vector<std::vector<cv::Point2f>>> outlines_;
  double yaw_rad_ = -0.5;
  double pitch_rad_ = -0.9;
  ReliefBox box_;
};

}  // namespace hapticast::client
