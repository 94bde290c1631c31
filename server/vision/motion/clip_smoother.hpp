// SPDX-License-Identifier: MIT
// Fixed-interval smoothing: Kalman filter and Rauch-Tung-Striebel smoother over the whole track of
// a recorded clip, whose window is the clip itself. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// Returns the motion at every sample of a track. The states of each coordinate are {p, v, a, jerk,
/// snap}; white noise drives the derivative of snap and disturbs the measurements.
/// Kalman filter and Rauch-Tung-Striebel smoother, in de Jong's (1989) form, yield the likeliest
/// states. A search finds the likeliest ratio of the two noises for this track.
/// An impact resets the variance of the velocity. Samples at rest over `lookahead` samples on
/// either side have exactly zero motion.
/// `samples`: in order of time. Sets position, velocity, acceleration (relative to the background)
/// and angles only.
std::vector<Motion> smoothedTrack(const std::vector<Sample>& samples,
                                  const std::vector<Impact>& impacts, int lookahead);

/// Motion of a clip's objects, by id, from all frames of its scan.
class ClipMotion {
  /// Motion of an object at one frame.
 public:
  struct Moment {
    Motion motion;
    Vec3 measured_mm = Vec3::Zero();  ///< pose that was smoothed
    double time_s = 0.0;              ///< in the clip, s
  };

  /// Adds the pose of an object in one frame of the clip; frames in order. `well`: seen and tracked
  /// well enough to measure motion.
  void add(std::uint32_t id, std::uint64_t frame, double time_s, const ObjectPose& pose, bool well);
  /// Smooths all tracks; call once after the last add(). `ended`: the clip ended there; else the
  /// last `lookahead` frames have no result, because later frames would change it.
  void smooth(const NominalFrame& nominal, int lookahead, bool ended);

  /// Returns the motion of `object` at `frame` of the clip. Null if the scan did not track it well,
  /// or saw it 0.25 mm or more from `measured_mm`: then it was another object.
  [[nodiscard]] const Moment* at(std::uint32_t object, std::uint64_t frame,
                                 const Vec3& measured_mm) const;
  /// Returns the impacts at most `reach_s` before or after `time_s` in the clip, oldest first.
  [[nodiscard]] std::vector<Impact> impactsAround(std::uint32_t object, double time_s,
                                                  double reach_s) const;
  /// Returns the magnitudes of well tracked accelerations, mm/s², more than `reach_s` from an
  /// impact.
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
