// SPDX-License-Identifier: MIT
// Computes the motion of a frame's objects from a window of frames around it: poses of many frames
// in; motion, impacts and grid of one frame out. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "server/source/rgbd_source.hpp"
#include "server/vision/motion/clip_smoother.hpp"
#include "server/vision/motion/impact.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/pose_history.hpp"
#include "server/vision/track.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

// Loop seam test: decides whether objects continue where a looped clip begins again, or a new epoch
// has to start. Thread: any.

/// Returns whether both frames show the same objects by id, all of them seen.
bool haveSameObjects(const std::vector<TrackedObject>& a, const std::vector<TrackedObject>& b);

/// Returns whether the same objects are unchanged since the frame before. Pose and relief together
/// may change the force by at most the error budget.
bool nothingMoved(const std::vector<TrackedObject>& before, const std::vector<TrackedObject>& now,
                  const NominalFrame& nominal, const VisionSettings& settings);

/// Returns the 0.99 quantile of the values, the largest acceleration that a stream announces,
/// mm/s². The maximum of hundreds of measured values would be the worst of their noise. 0 when
/// empty. Reorders the values.
double largestAcceleration_mm_s2(std::vector<double>& accelerations_mm_s2);

/// Motion of all objects over the frames of a stream.
class FrameMotion {
 public:
  /// Copies `info` and `settings`. `lookahead` in frames.
  FrameMotion(const SourceInfo& info, const VisionSettings& settings, int lookahead);

  /// Sets the motion that a scan of the clip found; the scan counted objects from 1. From now on
  /// frames of the clip use the whole clip as their window.
  void setClip(ClipMotion clip) { clip_ = std::move(clip); }
  /// Starts the clip anew; its first object has the id `first_object_id`.
  void beginClip(std::uint32_t first_object_id) { first_object_id_ = first_object_id; }

  /// Adds the objects of the next frame. `time_s`: media time.
  void add(std::uint64_t frame_id, double time_s, const std::vector<TrackedObject>& objects);
  /// Adds motion, impacts and grids to `frame`, which was added before. Requires that the
  /// lookahead's frames after it were added too, or that the stream ended. Call in order of frames.
  /// `clip_frame`: its index in the clip.
  void complete(HapticFrame& frame, std::uint64_t clip_frame, const NominalFrame& nominal);
  /// Starts a new epoch: no window reaches across.
  void forget();

  /// Returns the plans of the last added frame's objects, by object id.
  [[nodiscard]] const std::map<std::uint32_t, std::shared_ptr<ScenePlan>>& plans() const {
    return plans_;
  }
  /// Returns a running bound of |a| of a live source, mm/s², which never falls; 0: not enough
  /// frames.
  [[nodiscard]] double largestAcceleration_mm_s2() const { return largest_mm_s2_; }

 private:
  void findImpacts(HapticObject& object, const HapticFrame& frame, const MotionWindow& around);
  void setFromClip(HapticObject& object, MediaTime media_time, const Vec3& measured_mm,
                   std::uint64_t clip_frame) const;
  void addGrid(HapticObject& object, const HapticFrame& frame, const NominalFrame& nominal);
  void addResidual(HapticObject& object, const HapticFrame& frame, const NominalFrame& nominal);
  void boundAcceleration(const HapticObject& object);
  /// Reach of impacts around a frame, s.
  [[nodiscard]] double reach_s() const { return lookahead_ / info_.fps; }

  SourceInfo info_;
  VisionSettings settings_;
  int lookahead_;
  ClipMotion clip_;
  std::uint32_t first_object_id_ = 1;
  MotionHistory history_;
  std::map<std::uint32_t, ImpactFinder> impacts_;  // by object id
  std::map<std::uint32_t, std::shared_ptr<ScenePlan>> plans_;
  std::deque<double> live_accelerations_mm_s2_;
  double largest_mm_s2_ = 0.0;
};

}  // namespace hapticast::server
