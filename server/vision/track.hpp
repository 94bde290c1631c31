// SPDX-License-Identifier: MIT
// One object's way through the frames: it takes a segment of each frame and makes surface,
// stillness, presence, pose and cells of it. Thread: vision's.
#pragma once

#include <cstdint>

#include "common/time.hpp"
#include "server/vision/base/flow.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/motion/pose_tracker.hpp"
#include "server/vision/segment/segmenter.hpp"
#include "server/vision/surface/static_region_filter.hpp"
#include "server/vision/tracked_object.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// What all tracks of a clip share.
struct TrackSettings {
  VisionSettings vision;
  PoseSettings pose;
  bool exact_masks = false;      ///< the source's own
  const Clock* clock = nullptr;  ///< to tell how long stages take; null: nobody asks
};

class Track {
 public:
  /// Begins with the object's segment in this frame. `settings` must outlive it.
  Track(const TrackSettings& settings, const Segment& segment, const FramePair& frames);

  /// Ends a frame of the plan and tells whether the new one shows the object as it is held, all of
  /// it at rest, and the plan leaves out what would measure it again; not where the author has a
  /// word on this frame (`told`). First of a frame.
  bool isResting(const FramePair& frames, bool told);
  /// Where the object went since the last frame: what carries its mask. After rests().
  const ObjectFlow& computeFlow(const FramePair& frames);
  /// Its segment in this frame. Last of a frame, or lose().
  void update(const Segment& segment, const FramePair& frames);
  /// It has no segment in this frame: it stays where it was, its quality falls.
  void lose();
  /// How far the background has moved behind it in this frame, px.
  void addBackground(const cv::Vec2d& step_px) { background_px_ += step_px; }

  [[nodiscard]] const TrackedObject& object() const { return now_; }
  /// Of the last frame that it was seen in: 0 / 255, size of the picture.
  [[nodiscard]] const cv::Mat& mask() const { return mask_; }
  /// Lost for so long that it is given up.
  [[nodiscard]] bool isGone() const { return lost_ > kKeepLost; }

  static constexpr int kKeepLost = 5;  ///< frames; chosen, 0.2 s at 25 fps

 private:
  [[nodiscard]] bool repeatsDepth(const FramePair& frames, const cv::Mat& mask) const;
  [[nodiscard]] Surface denoisedSurface(const Segment& segment, const FramePair& frames);
  void hold(const FramePair& frames, bool repeated);
  void updatePresence(const Segment& segment, bool blind);
  [[nodiscard]] CellFlow cells(const FramePair& frames, const Surface& before) const;

  const TrackSettings* settings_;
  TrackedObject now_;
  cv::Mat mask_;
  PoseTracker motion_;
  StaticRegionFilter hold_;
  ObjectFlow flow_;            // from the last frame to this one
  bool rests_ = false;         // in this frame nothing of it has changed
  int lost_ = 0;               // frames
  double full_area_px_ = 0.0;  // of the whole object, at its present size
  cv::Vec2d last_step_px_{0, 0};
  cv::Vec2d background_px_{0, 0};  // how far it has moved behind the object
};

}  // namespace hapticast::server
