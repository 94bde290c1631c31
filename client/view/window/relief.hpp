// SPDX-License-Identifier: MIT
// The reliefs that are felt, as the window shows them on demand: outlined, shaded over the picture,
// or turned in space with the tip beside them. Thread: takeFrame() any, everything else main.
#pragma once

#include <imgui.h>

#include <deque>
#include <mutex>
#include <optional>
#include <vector>

#include "client/haptics/playback/playable_reliefs.hpp"
#include "client/view/relief_shape.hpp"
#include "client/view/window/scene.hpp"

namespace hapticast::client {

/// How the relief is shown, one after the other on one key.
enum class ReliefLook : std::uint8_t { kNone, kShaded, kInSpace };

class WindowRelief {
 public:
  /// As many as the loop holds: the reliefs of older ones are gone.
  static constexpr std::size_t kMostFrames = 32;

  /// Remembers the frame without keeping its reliefs.
  void onFrame(const PlayableReliefs& frame);
  /// Takes the frame that is felt at this time; while time stands, it stays.
  void update(MediaTime play_time, const Workspace& workspace);
  /// Seen from another side: px that it was dragged by.
  void rotate(float right_px, float down_px);

  void drawOutline(ImDrawList& list, const ScenePlace& place);
  void drawShaded(ImDrawList& list, const ScenePlace& place);
  /// In a box of its own.
  void drawInSpace(ImDrawList& list, const ScenePlace& place, const TickReport& report);
  /// Where that box is, in the lower left corner of the picture.
  [[nodiscard]] static ImVec4 box(const ScenePlace& place);

 private:
  const ReliefMesh& mesh(const ScenePlace& place);

  std::mutex mutex_;
  std::deque<PlayableReliefs> frames_;  // guarded by mutex_
  std::optional<MediaTime> shown_;
  Reliefs reliefs_;  // of that frame
  Workspace workspace_;
  // Made of them when somebody wants to see them.
  std::optional<ReliefMesh> mesh_;
  int cell_px_ = 0;  // of mesh_, at least
  std::optional<std::vector<std::vector<cv::Point2f>>> outlines_;
  double yaw_rad_ = -0.5;
  double pitch_rad_ = -0.9;
};

}  // namespace hapticast::client
