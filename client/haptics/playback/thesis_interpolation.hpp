// SPDX-License-Identifier: MIT
// The thesis's way in time (--method thesis): displacements of whole frames at a HIP assumed to
// stand still, interpolated from the video's rate to 1 kHz by cubics. Real-time room: noexcept, no
// heap, no locks.
#pragma once

#include <cstdint>

#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/playback/scene_interpolator.hpp"

namespace hapticast::client {

class ThesisInterpolation {
 public:
  /// Eq. 3 over k in the frames i-1 .. i+2 around play time, each with its own relief where it
  /// stood, at the HIP of the moment in which the interval [i, i+1] was entered; between them a
  /// Catmull-Rom cubic. Linear where i-1 or i+2 is missing, held where i+1 is. The surface counts
  /// as standing still. `contact.object` (the object touched in frame i or i+1, its acceleration
  /// linear in between) holds until the next call. `jump` at the first look-up of an epoch and of
  /// an object that was not in frame i-1; one that is not in frame i is not yet there. The HIP
  /// freezes anew when the interval, and so the epoch, changes.
  Contact evaluate(const SceneInterpolator& lookup, MediaTime play_time, const Vec3& hip_mm,
                   const Workspace& workspace) noexcept;

 private:
  bool enter(const PlayFrame& from, const Vec3& hip_mm) noexcept;

  bool entered_ = false;
  std::uint32_t epoch_ = 0;
  std::uint64_t frame_id_ = 0;  // i
  Vec3 frozen_hip_mm_ = Vec3::Zero();
  InterpolatedObject object_;
};

}  // namespace hapticast::client
