// SPDX-License-Identifier: MIT
// Smooths the track of an object over a whole recorded clip (fixed-interval smoothing). It uses a
// Kalman filter and a Rauch-Tung-Striebel smoother. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// Returns the motion at every sample of a track: position, velocity, acceleration (relative to the
/// background) and angles. Other fields have their defaults. A Kalman filter and a
/// Rauch-Tung-Striebel smoother, in de Jong's (1989) form, find the likeliest motion. Each
/// coordinate has the states {p, v, a, jerk, snap}. The model has two white noises: one changes the
/// derivative of snap, the other disturbs the measurements. A search finds the likeliest ratio of
/// the two noises for this track. At each of `impacts` the velocity may jump. A sample has exactly
/// zero motion if the object rests over `lookahead` samples on either side. `samples` are in order
/// of time.
std::vector<Motion> smoothTrack(const std::vector<Sample>& samples,
                                const std::vector<Impact>& impacts, int lookahead);

/// Motion of a clip's objects, computed from all frames of the clip's scan. Call add() for all
/// frames, then smooth() once; only then are the other functions valid.
class ClipMotion {
 public:
  /// Motion of an object at one frame.
  struct Moment {
    Motion motion;
    Vec3 measured_mm = Vec3::Zero();  ///< measured position before smoothing, nominal mm
    double time_s = 0.0;              ///< time of the frame in the clip, s
  };

  /// Adds the pose of an object in one frame of the clip; frames in order. `well`: whether the
  /// object was visible and tracked well enough to measure its motion.
  void add(std::uint32_t id, std::uint64_t frame, double time_s, const ObjectPose& pose, bool well);
  /// Smooths all tracks. `ended`: whether the scan reached the clip's end. If it did not, the last
  /// `lookahead` frames have no result, because later frames would change it.
  void smooth(const NominalFrame& nominal, int lookahead, bool ended);

  /// Returns the motion of `object` at `frame` of the clip. Returns null if the scan did not track
  /// the object well there. Also returns null if the position that the scan measured is 0.25 mm or
  /// more from `measured_mm`, because the scan then tracked another object.
  [[nodiscard]] const Moment* at(std::uint32_t object, std::uint64_t frame,
                                 const Vec3& measured_mm) const;
  /// Returns the impacts of `object` at most `reach_s` before or after `time_s`, oldest first.
  /// `time_s` is a time in the clip, s.
  [[nodiscard]] std::vector<Impact> findImpactsAround(std::uint32_t object, double time_s,
                                                      double reach_s) const;
  /// Returns the magnitudes of all accelerations in frames that were tracked well, mm/s². Frames at
  /// most `reach_s` from an impact are left out.
  [[nodiscard]] std::vector<double> accelerations_mm_s2(double reach_s) const;

 private:
  struct Entry {
    std::uint64_t frame = 0;
    double time_s = 0.0;
    ObjectPose pose;
    bool well_tracked = true;
  };
  struct Track {
    std::map<std::uint64_t, Moment> moments;  // by frame
    std::vector<Impact> impacts;
  };
  std::map<std::uint32_t, std::vector<Entry>> entries_;
  std::map<std::uint32_t, Track> tracks_;
};

}  // namespace hapticast::server
