// SPDX-License-Identifier: MIT
// How the objects of a frame move, told when the frames around it are known: poses of many frames
// in, motion, impacts and grid of one out. Thread: vision's.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "server/source/rgbd_source.hpp"
#include "server/vision/motion/clip_smoother.hpp"
#include "server/vision/motion/impact.hpp"
#include "server/vision/motion/pose_history.hpp"
#include "server/vision/tracked_object.hpp"

namespace hapticast::server {

/// What a clip's largest acceleration is announced as: the 0.99 quantile, because the one largest
/// of hundreds of measured values is the worst of their noise. 0 when empty. Reorders.
double largestAcceleration_mm_s2(std::vector<double>& accelerations_mm_s2);

class FrameMotion {
 public:
  /// `info` and `settings` are copied. `lookahead` in frames.
  FrameMotion(const SourceInfo& info, const VisionSettings& settings, int lookahead);

  /// What a scan saw of the clip, which counted its objects from 1: from now on frames of it have
  /// all of it as their window.
  void setClip(ClipMotion clip) { clip_ = std::move(clip); }
  /// The clip begins again; its first object will have the id `first_object_id`.
  void beginClip(std::uint32_t first_object_id) { first_object_id_ = first_object_id; }

  /// The next frame's objects.
  void add(std::uint64_t frame_id, double time_s, const std::vector<TrackedObject>& objects);
  /// Fills in the motion, impacts and grids of a frame that was added, when the lookahead's frames
  /// after it have been, too (or never will be). In order. `clip_frame`: its number in the clip.
  void complete(HapticFrame& frame, std::uint64_t clip_frame, const NominalFrame& nominal);
  /// A new epoch: nothing reaches across.
  void forget();

  /// Plans of the objects of the last frame that was added, by object id.
  [[nodiscard]] const std::map<std::uint32_t, std::shared_ptr<ScenePlan>>& plans() const {
    return plans_;
  }
  /// Of a live source: a running bound of |a|, which never falls; 0: not known yet.
  [[nodiscard]] double largestAcceleration_mm_s2() const { return largest_mm_s2_; }

 private:
  void findImpacts(HapticObject& object, const HapticFrame& frame, const MotionWindow& around);
  void setFromClip(HapticObject& object, MediaTime media_time, const Vec3& measured_mm,
                   std::uint64_t clip_frame) const;
  void addGrid(HapticObject& object, const HapticFrame& frame, const NominalFrame& nominal);
  void addResidual(HapticObject& object, const HapticFrame& frame, const NominalFrame& nominal);
  void boundAcceleration(const HapticObject& object);
  /// How far around a frame its impacts are told.
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
