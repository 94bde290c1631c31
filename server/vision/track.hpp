// SPDX-License-Identifier: MIT
// Track of one object over the frames: turns its segment in each frame into surface, rest,
// presence, pose and cells. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <memory>

#include "common/time.hpp"
#include "server/vision/base/flow.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/motion/grid.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/pose_tracker.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/segment/segmenter.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/surface/static_region_filter.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

// Result of tracking for one object in one frame: surface, pose and residual motion. Thread: the
// one that runs Vision.

/// One object in one frame.
struct TrackedObject {
  std::uint32_t id = 0;
  bool seen = true;  ///< false: lost, stays at its last position
  Surface surface;
  ObjectPose pose;
  CellFlow cells;                 ///< residual motion; empty if the plan or the method omits it
  double quality = 1.0;           ///< of the tracking, 0..1
  double visible_fraction = 1.0;  ///< visible share of the area, 0..1
  /// Stages that are off; never null.
  std::shared_ptr<ScenePlan> plan = std::make_shared<ScenePlan>(PlanSettings{}, false);
  double held_share = 0.0;  ///< held share of the surface, 0..1; 1: all of it rests

  [[nodiscard]] bool atRest() const { return held_share >= 1.0; }
  /// Returns whether the tracking is good enough to measure motion; else the motion is
  /// extrapolated.
  [[nodiscard]] bool isWellTracked() const { return quality >= kGoodQuality; }

  static constexpr double kGoodQuality = 0.75;  ///< chosen: between 1 and a doubtful step's 0.7
};

/// Settings that all tracks of a clip share.
struct TrackSettings {
  VisionSettings vision;
  PoseSettings pose;
  bool exact_masks = false;      ///< the source's own masks
  const Clock* clock = nullptr;  ///< measures durations of stages; null: no measurement
};

/// Track of one object. Each frame: isResting(), computeFlow(), then update() or lose().
class Track {
 public:
  /// Starts with the object's segment in this frame. `settings` must outlive the track.
  Track(const TrackSettings& settings, const Segment& segment, const FramePair& frames);

  /// Starts a frame of the plan. Returns whether the frame shows the held object: all of it at
  /// rest, and no active stage would measure it again. False if the author annotated this frame
  /// (`told`).
  bool isResting(const FramePair& frames, bool told);
  /// Returns the motion of the object since the last frame, which moves its mask. Call after
  /// isResting().
  const ObjectFlow& computeFlow(const FramePair& frames);
  /// Adds the object's segment in this frame. Last call of a frame, in place of lose().
  void update(const Segment& segment, const FramePair& frames);
  /// Marks the object as lost in this frame: its pose stays and its quality falls.
  void lose();
  /// Adds the motion of the background behind the object in this frame, px.
  void addBackground(const cv::Vec2d& step_px) { background_px_ += step_px; }

  [[nodiscard]] const TrackedObject& object() const { return now_; }
  /// Mask of the last frame that showed the object: CV_8UC1, 0/255, image size.
  [[nodiscard]] const cv::Mat& mask() const { return mask_; }
  /// Returns whether the object was lost for more than kKeepLost frames.
  [[nodiscard]] bool isGone() const { return lost_ > kKeepLost; }

  static constexpr int kKeepLost = 5;  ///< frames of a lost object; chosen, 0.2 s at 25 fps

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
  bool rests_ = false;         // nothing of it changed in this frame
  int lost_ = 0;               // frames
  double full_area_px_ = 0.0;  // area of the whole object at its present size
  cv::Vec2d last_step_px_{0, 0};
  cv::Vec2d background_px_{0, 0};  // motion of the background behind the object, accumulated
};

}  // namespace hapticast::server
