// SPDX-License-Identifier: MIT
// The thesis's temporal interpolation (--method thesis): Catmull-Rom splines raise the
// displacements of whole frames from the video's rate to 1 kHz. The HIP counts as standing still
// within an interval.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>

#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/playback/scene_interpolator.hpp"

namespace hapticast::client {

/// State of the temporal interpolation: the current interval and its HIP.
class ThesisInterpolation {
 public:
  /// Returns the contact at play time.
  ///
  /// Evaluates Eq. 3 divided by k in the frames i-1 .. i+2 around play time. Each frame has its own
  /// relief at its own place. The HIP is that of the begin of the interval [i, i+1]. A Catmull-Rom
  /// cubic connects the four displacements. The result is linear if frame i-1 or i+2 is missing,
  /// and constant if i+1 is missing. The surface velocity is zero.
  ///
  /// `contact.object` is the touched object of frame i or i+1, with linear acceleration; valid
  /// until the next call. `jump` is set at the first tick of an epoch, and for an object that is
  /// not in frame i-1. An object that is not in frame i does not exist yet. A new interval, and so
  /// a new epoch, reads the HIP again.
  Contact evaluate(const SceneInterpolator& lookup, MediaTime play_time, const Vec3& hip_mm,
                   const Workspace& workspace) noexcept;

 private:
  bool enter(const PlayFrame& from, const Vec3& hip_mm) noexcept;

  bool entered_ = false;
  std::uint32_t epoch_ = 0;
  std::uint64_t frame_id_ = 0;  // id of frame i
  Vec3 frozen_hip_mm_ = Vec3::Zero();
  InterpolatedObject object_;
};

}  // namespace hapticast::client
