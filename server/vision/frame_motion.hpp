// SPDX-License-Identifier: MIT
// Computes the motion of a frame's objects from a window of frames around that frame. The input is
// the objects' poses in the window. The output is motion, impacts and motion grids of the frame.
// Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "server/source/rgbd_source.hpp"
#include "server/vision/motion/clip_smoother.hpp"
#include "server/vision/motion/impact.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/pose_history.hpp"
#include "server/vision/track.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns whether both frames contain objects with the same ids, and all these objects are visible
/// in both frames. If not, a new epoch begins where a looped clip begins again. Thread: any.
bool haveSameObjects(const std::vector<TrackedObject>& a, const std::vector<TrackedObject>& b);

/// Returns whether `now` has the same objects as `before`, and no object changed noticeably. A
/// change is noticeable if the changes of pose and relief together change the force by more than
/// the error budget.
bool isAllAtRest(const std::vector<TrackedObject>& before, const std::vector<TrackedObject>& now,
                 const NominalFrame& nominal, const VisionSettings& settings);

/// Returns the bound of the objects' accelerations, mm/s². The server sends this bound to clients
/// in the welcome. It is the 0.99 quantile of `accelerations_mm_s2`, or 0 if there are none. It is
/// not the maximum, because the largest of hundreds of measured values is mainly noise. Reorders
/// `accelerations_mm_s2`.
double largestAcceleration_mm_s2(std::vector<double>& accelerations_mm_s2);

/// Computes the motion of all objects of a stream, frame by frame.
class FrameMotion {
 public:
  /// Copies `info` and `settings`. `lookahead`: number of frames in a window on each side of its
  /// frame. `clock` measures durations and must outlive FrameMotion; null: no measurement.
  FrameMotion(const SourceInfo& info, const VisionSettings& settings, int lookahead,
              const Clock* clock);

  /// Sets the motion that a scan of the whole clip found. From then on it replaces the motion that
  /// the short windows yield. The scan numbered the objects from 1.
  void setClip(ClipMotion clip) { clip_ = std::move(clip); }
  /// Begins a new playback of the clip, in which the clip's first object has the id
  /// `first_object_id`.
  void beginClip(std::uint32_t first_object_id) { first_object_id_ = first_object_id; }

  /// Adds the objects of the next frame, and measures their motion in cells. `time_s`: media time
  /// of the frame, s. Returns the measured durations, by object id.
  std::map<std::uint32_t, StageReport> add(std::uint64_t frame_id, double time_s,
                                           const std::vector<TrackedObject>& objects);
  /// Writes motion, impacts and motion grids into the objects of `frame`. The objects of this frame
  /// and of `lookahead` frames after it must have been added, or the stream must have ended. Call
  /// it in order of the frames. `clip_frame`: index of the frame in the clip.
  void complete(HapticFrame& frame, std::uint64_t clip_frame, const NominalFrame& nominal);
  /// Replaces the mass of objects without a mass of their own.
  void setMass(std::optional<double> mass_kg) { settings_.mass_kg = mass_kg; }
  /// Begins a new epoch: deletes all poses, so that no window contains frames of the old epoch.
  void forget();

  /// Returns the measured cost of each object's motion grid in the completed frames, by object id.
  /// It has the objects of the last added frame.
  [[nodiscard]] const std::map<std::uint32_t, StageReport>& reports() const { return reports_; }
  /// Returns the bound of all accelerations of a live source so far, mm/s². The bound never
  /// decreases. Returns 0 until enough frames have been measured.
  [[nodiscard]] double largestAcceleration_mm_s2() const { return largest_mm_s2_; }

 private:
  CellFlow measureCells(const TrackedObject& object, const CellFlow& last,
                        StageReport& report) const;
  void findImpacts(HapticObject& object, const HapticFrame& frame, const MotionWindow& around);
  void setFromClip(HapticObject& object, MediaTime media_time, const Vec3& measured_mm,
                   std::uint64_t clip_frame) const;
  void addGrid(HapticObject& object, const HapticFrame& frame, const NominalFrame& nominal);
  void addResidual(HapticObject& object, const HapticFrame& frame, const NominalFrame& nominal);
  void boundAcceleration(const HapticObject& object);
  /// Returns how far an impact may lie before or after a frame that reports it, s.
  [[nodiscard]] double reach_s() const { return lookahead_ / info_.fps; }

  SourceInfo info_;
  VisionSettings settings_;
  int lookahead_;
  const Clock* clock_;
  ClipMotion clip_;
  std::uint32_t first_object_id_ = 1;
  MotionHistory history_;
  std::map<std::uint32_t, ImpactFinder> impacts_;  // finder of each object, by its id
  std::map<std::uint32_t, CellFlow> cells_;        // of each object in its last frame
  std::map<std::uint32_t, StageReport> reports_;
  std::deque<double> live_accelerations_mm_s2_;
  double largest_mm_s2_ = 0.0;
};

}  // namespace hapticast::server
