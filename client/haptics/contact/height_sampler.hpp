// SPDX-License-Identifier: MIT
// Samples the heights and the edge distances of a moving relief, for the proxy. It counts the
// height samples of each tick, because the real-time budget limits their number. A cache stores one
// height sample and one edge sample. A stored sample is valid until the pair of frames around play
// time changes.
//
// All points are in the object's frame, nominal mm.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/contact/moving_relief.hpp"

namespace hapticast::client {

/// Samples one relief for one proxy.
class ReliefProbe {
 public:
  /// A height sample: the heights in the two frames around play time, and their blend at play time.
  struct Height {
    MovingRelief::Heights frames;
    BlendedHeight now;
  };

  /// Starts a tick. The tick may read up to `samples` heights of `relief`, which must outlive the
  /// tick.
  ///
  /// Edge samples are not counted, because the proxy reads only a bounded number of them in a tick.
  /// Most ticks need no new edge sample. A stored edge distance e is sufficient for all points
  /// within about 0.8 |e| of its point, because the edge is farther away.
  void begin(const MovingRelief& relief, int samples) noexcept;
  /// Invalidates both stored samples.
  void forget() noexcept { height_known_ = edge_known_ = false; }

  [[nodiscard]] const MovingRelief& relief() const noexcept { return *relief_; }
  /// Returns the number of height samples that this tick may still read.
  [[nodiscard]] int left() const noexcept { return left_; }
  /// Returns the number of height samples that this tick has read.
  [[nodiscard]] int used() const noexcept { return used_; }

  /// Returns the height at `q_mm`. If `q_mm` is the point of the stored sample, the result is that
  /// sample. Otherwise the function reads a new sample and counts it. It does not store that
  /// sample: call keep().
  [[nodiscard]] Height height(const Vec2& q_mm) noexcept;
  /// Returns the edge distance (mm, positive inside) at `q_mm` and stores the sample.
  [[nodiscard]] EdgeSample edge(const Vec2& q_mm) noexcept;
  /// Returns true if `q_mm` lies inside the mask at play time. The call may read and store an edge
  /// sample.
  [[nodiscard]] bool isMasked(const Vec2& q_mm) noexcept;
  /// Stores `height` as the sample at `q_mm`.
  void keep(const Vec2& q_mm, const Height& height) noexcept;
  /// Returns the speed (mm/s) at which the change of the shape moves the mask's edge outwards, at
  /// the point of the last edge sample.
  [[nodiscard]] double edgeRate_mm_s() const noexcept { return relief_->rate_mm_s(edge_); }

 private:
  const MovingRelief* relief_ = nullptr;
  int left_ = 0;
  int used_ = 0;
  bool height_known_ = false;
  Vec2 height_q_mm_ = Vec2::Zero();
  MovingRelief::Heights height_;
  bool edge_known_ = false;
  Vec2 edge_q_mm_ = Vec2::Zero();
  MovingRelief::Edges edge_;
};

}  // namespace hapticast::client
