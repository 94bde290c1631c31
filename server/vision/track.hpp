// SPDX-License-Identifier: MIT
// Track of one object over the frames. From the object's segment (its mask in a frame) it computes
// the surface, the pose and the cell motion, and whether the object is at rest or lost. Thread: the
// one that runs Vision.
#pragma once

#include <cstdint>
#include <utility>

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

/// Result of tracking one object in one frame: surface, pose and residual motion. Thread: the one
/// that runs Vision.
struct TrackedObject {
  std::uint32_t id = 0;
  int number = 0;    ///< see Segment
  bool seen = true;  ///< false: the object is lost and remains at its last position
  Surface surface;
  Surface measured;  ///< the surface that this frame alone measured; empty if it measured none
  ObjectPose pose;
  CellInput cells;                ///< input of the motion in cells, which FrameMotion measures
  double quality = 1.0;           ///< quality of the tracking, 0..1
  double visible_fraction = 1.0;  ///< visible share of the object's area, 0..1
  bool smooths = true;            ///< whether the scene plan has the stage `smooth` on
  bool measures_smooth = true;    ///< whether this frame measures the cost without that stage
  bool measures_grid = true;      ///< whether the scene plan has the stage `grid` on
  /// Share of the surface that is held constant, 0..1; 1: all of it rests.
  double held_share = 0.0;

  [[nodiscard]] bool atRest() const { return held_share >= 1.0; }
  /// Returns whether the tracking is good enough to measure motion. Otherwise the motion is
  /// extrapolated.
  [[nodiscard]] bool isWellTracked() const { return quality >= kGoodQuality; }

  /// Least quality of tracking that is good enough to measure motion. The value is a choice between
  /// 1 (a sure measurement) and 0.7 (a doubtful one).
  static constexpr double kGoodQuality = 0.75;
};

/// Settings that all tracks of a clip share.
struct TrackSettings {
  VisionSettings vision;
  PoseSettings pose;
  bool exact_masks = false;      ///< whether the masks are the source's own
  const Clock* clock = nullptr;  ///< measures durations of stages; null: no measurement
};

/// Track of one object, with its scene plan. In each frame call isResting(), computeFlow(), then
/// update() or lose(), and endFrame(); in the track's first frame only endFrame(). computeFlow()
/// may be omitted in frames in which all objects rest.
class Track {
 public:
  /// Begins the track with the object's segment in this frame. `settings` must outlive the track.
  Track(const TrackSettings& settings, const Segment& segment, const FramePair& frames);

  /// Begins the next frame. Returns whether the object rests in it; update() then leaves surface
  /// and pose as they are. It rests if the frame repeats the last one. It also rests if the plan
  /// has switched off segmentation and motion, and the frame shows the whole object unchanged.
  /// `annotated`: true if an annotation changes this frame (Segmenter::hasAnnotation()); the result
  /// is then false.
  bool isResting(const FramePair& frames, bool annotated);
  /// Returns the object's motion in the picture since the last frame; the segmenter moves its mask
  /// by it. Call it after isResting().
  const ObjectFlow& computeFlow(const FramePair& frames);
  /// Computes surface and pose from the object's segment in this frame. If the object has no
  /// segment, call lose() in its place.
  void update(const Segment& segment, const FramePair& frames);
  /// Marks the object as lost in this frame: its pose remains and its quality decreases.
  void lose();
  /// Ends the frame: adds the measurements of update() to the scene plan.
  void endFrame() { report(std::exchange(report_, {})); }
  /// Decides which stages after the tracker run for `object` in this frame. Call it after the
  /// later stages' reports of the last frame.
  void decideStages(TrackedObject& object) const;
  /// Adds another stage's measurements of the object to the scene plan.
  void report(const StageReport& report) { plan_.add(report); }
  /// Adds the motion of the background behind the object in this frame, px right and px down.
  void addBackground(const cv::Vec2d& step_px) { background_px_ += step_px; }

  [[nodiscard]] const TrackedObject& object() const { return now_; }
  [[nodiscard]] const ScenePlan& plan() const { return plan_; }
  /// Returns the mask of the last frame with the object: CV_8UC1, 0/255, size of the image.
  [[nodiscard]] const cv::Mat& mask() const { return mask_; }
  /// Returns whether the object was lost for more than kKeepLost frames.
  [[nodiscard]] bool isGone() const { return lost_ > kKeepLost; }

  /// Number of frames for which a lost object remains in the results. The value is a choice: 0.2 s
  /// at 25 fps.
  static constexpr int kKeepLost = 5;

 private:
  [[nodiscard]] bool repeatsDepth(const FramePair& frames, const cv::Mat& mask) const;
  [[nodiscard]] Surface denoiseSurface(const Segment& segment, const FramePair& frames);
  void hold(const FramePair& frames, bool repeated);
  void updatePresence(const Segment& segment, bool blind);
  [[nodiscard]] CellInput cellInput(const FramePair& frames, const Surface& before) const;

  const TrackSettings* settings_;
  ScenePlan plan_;
  StageReport report_;  // of this frame
  TrackedObject now_;
  cv::Mat mask_;
  PoseTracker motion_;
  StaticRegionFilter hold_;
  ObjectFlow flow_;            // motion in the picture from the last frame to this one
  bool rests_ = false;         // the object did not change in this frame
  int lost_ = 0;               // frames since the object was lost; 0: present
  double full_area_px_ = 0.0;  // area of the whole object at its present size
  cv::Point2d middle_px_;      // centroid of mask_
  cv::Vec2d last_step_px_{0, 0};
  cv::Vec2d background_px_{0, 0};  // sum of the background's motion behind the object
};

}  // namespace hapticast::server
