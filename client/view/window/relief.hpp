// SPDX-License-Identifier: MIT
// Reliefs in the window, on demand: outlines, shaded over the picture, or rotatable in space beside
// the HIP.
// Thread: onFrame() any, everything else main.
#pragma once

#include <imgui.h>

#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/view/relief_shape.hpp"
#include "client/view/window/scene.hpp"

namespace hapticast::client {

/// Display of the relief; one key cycles through it.
enum class ReliefLook : std::uint8_t { kNone, kShaded, kInSpace };

/// The reliefs of the rendered frame.
class WindowRelief {
 public:
  /// As many as the loop holds: older frames have lost their reliefs.
  static constexpr std::size_t kMostFrames = 32;

  /// Stores the frame with weak references to its reliefs.
  void onFrame(const PlayableReliefs& frame);
  /// Selects the frame at this play time. While play time is paused, the selection remains.
  void update(MediaTime play_time, const Workspace& workspace);
  /// Rotates the view by a drag of this many px.
  void rotate(float right_px, float down_px);

  void drawOutline(ImDrawList& list, const ScenePlace& place);
  void drawShaded(ImDrawList& list, const ScenePlace& place);
  /// Draws into the box of box().
  void drawInSpace(ImDrawList& list, const ScenePlace& place, const TickReport& report);
  /// Returns the box in the lower left corner of the picture: left, top, right, bottom.
  [[nodiscard]] static ImVec4 box(const ScenePlace& place);

 private:
  const ReliefMesh& mesh(const ScenePlace& place);

  std::mutex mutex_;
  std::deque<PlayableReliefs> frames_;  // guarded by mutex_
  std::optional<MediaTime> shown_;
  Reliefs reliefs_;  // of the selected frame
  Workspace workspace_;
  // Built from reliefs_ on demand:
  std::optional<ReliefMesh> mesh_;
  int cell_px_ = 0;  // smallest cell of mesh_
  std::optional<std::vector<std::vector<cv::Point2f>>> outlines_;
  double yaw_rad_ = -0.5;
  double pitch_rad_ = -0.9;
};

}  // namespace hapticast::client
