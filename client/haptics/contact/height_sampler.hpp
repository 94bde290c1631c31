// SPDX-License-Identifier: MIT
// Sample cache of a moving relief for the proxy. It counts the height samples of a tick and stores
// the last height sample and the last edge sample. A stored sample is valid until the pair of
// frames changes.
//
// All points are in the object's frame, nominal mm.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/contact/moving_relief.hpp"

namespace hapticast::client {

class ReliefProbe {
 public:
  /// A height sample: its two parts, one for each frame, and their blend at play time.
  struct Height {
    MovingRelief::Heights frames;
    BlendedHeight now;
  };

  /// Starts a tick with a budget of `samples` heights of `relief`; `relief` must outlive the tick.
  /// Edge samples are not counted: the number of phases of a tick bounds them. Most ticks need no
  /// new edge sample, because the stored one answers for every point that is nearer to it than the
  /// edge.
  void begin(const MovingRelief& relief, int samples) noexcept;
  /// Invalidates the stored samples.
  void forget() noexcept { height_known_ = edge_known_ = false; }

  [[nodiscard]] const MovingRelief& relief() const noexcept { return *relief_; }
  /// Remaining height samples of this tick.
  [[nodiscard]] int left() const noexcept { return left_; }
  /// Height samples of this tick so far.
  [[nodiscard]] int used() const noexcept { return used_; }

  /// Returns the height at `q_mm`: the stored sample if it belongs to this point, else a new
  /// sample, which counts.
  [[nodiscard]] Height height(const Vec2& q_mm) noexcept;
  /// Returns the edge distance (mm, positive inside) at `q_mm` and stores the sample.
  [[nodiscard]] EdgeSample edge(const Vec2& q_mm) noexcept;
  /// Returns true if `q_mm` lies within the mask at play time. May read and store an edge sample.
  [[nodiscard]] bool masked(const Vec2& q_mm) noexcept;
  /// Stores `height` as the sample at `q_mm`.
  void keep(const Vec2& q_mm, const Height& height) noexcept;
  /// Speed at which the change of shape moves the edge outwards, at the last edge sample, mm/s.
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
