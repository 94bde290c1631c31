// SPDX-License-Identifier: MIT
// Motion of a recorded clip, from all of it: what was looked through once may be smoothed with the
// whole clip as the window (fixed-interval smoothing). Thread: vision's.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/motion/nominal_frame.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// Motion at every sample of a track: per coordinate the states {p, v, a, jerk, snap} that are
/// likeliest for white noise on the derivative of snap and on the measurements (what a Kalman
/// filter and Rauch-Tung-Striebel smoother find, in de Jong's form of it); the ratio of the two
/// noises is the likeliest for this track. At an impact the velocity is set free. What stands still
/// over a window of `lookahead` samples on either side comes out as exactly that. `samples` in
/// order of time. Only position, velocity, acceleration (against the background) and angles are
/// set.
std::vector<Motion> smoothedTrack(const std::vector<Sample>& samples,
                                  const std::vector<Impact>& impacts, int lookahead);

/// What a scan of the clip saw of each object (by id), and its motion from all of that.
class ClipMotion {
 public:
  struct Moment {
    Motion motion;
    Vec3 measured_mm = Vec3::Zero();  ///< the pose that went into it
    double time_s = 0.0;              ///< in the clip
  };

  /// Where an object was in one frame of the clip, in order. `well`: it was seen and followed well
  /// enough to tell its motion.
  void add(std::uint32_t id, std::uint64_t frame, double time_s, const ObjectPose& pose, bool well);
  /// When all have been added. `ended`: that was all of the clip; else the last `lookahead` frames
  /// stay unknown, because what follows them would tell more.
  void smooth(const NominalFrame& nominal, int lookahead, bool ended);

  /// Null where the scan did not see the object well, or saw it elsewhere (0.25 mm and more from
  /// `measured_mm`): then it was not this one.
  [[nodiscard]] const Moment* at(std::uint32_t object, std::uint64_t frame,
                                 const Vec3& measured_mm) const;
  /// Impacts at most `reach_s` before or after `time_s` in the clip, oldest first.
  [[nodiscard]] std::vector<Impact> impactsAround(std::uint32_t object, double time_s,
                                                  double reach_s) const;
  /// Sizes of the accelerations where it was seen well, more than `reach_s` from an impact.
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
