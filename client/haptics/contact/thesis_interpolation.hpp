// SPDX-License-Identifier: MIT
// Temporal interpolation by the thesis's method (--method thesis). It computes one displacement in
// each frame. Catmull-Rom splines then interpolate these displacements to 1 kHz. The method assumes
// that the HIP does not move between two frames.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>

#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/playback/scene_interpolator.hpp"

namespace hapticast::client {

/// State of the interpolation: the current interval between two frames, and the HIP at its begin.
class ThesisInterpolation {
 public:
  /// Returns the contact at play time, in nominal mm.
  ///
  /// The method evaluates Eq. 3, divided by k, in the four frames i-1 .. i+2 around play time. Each
  /// frame has its own relief at its own position. All four use the HIP at the begin of the
  /// interval [i, i+1]. A Catmull-Rom cubic connects the four displacements. The result is linear
  /// if frame i-1 or i+2 is missing, and constant if i+1 is missing. The surface velocity is zero.
  ///
  /// `contact.object` is the touched object of frame i or i+1, with a linearly interpolated
  /// acceleration. It is valid until the next call. `contact.jump` is true in the first tick of an
  /// epoch. It is also true in the first tick of an interval, if the object is missing in frame
  /// i-1. Objects that are missing in frame i are ignored. `hip_mm` has an effect only in the first
  /// tick of an interval.
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
