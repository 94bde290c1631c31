// SPDX-License-Identifier: MIT
// How the proxy reads a moving relief: it counts what it reads and keeps the last samples, which
// hold as long as the pair of frames does. Object's frame, nominal mm. Real-time room.
#pragma once

#include "client/haptics/contact/moving_relief.hpp"

namespace hapticast::client {

class ReliefProbe {
 public:
  struct Height {
    MovingRelief::Heights frames;
    BlendedHeight now;
  };

  /// A tick begins that may read `samples` heights of `relief`. Samples of the edge are not
  /// counted: the number of the proxy's phases bounds them, and mostly none is read, since the kept
  /// one also answers for every point that is nearer to it than the edge.
  void begin(const MovingRelief& relief, int samples) noexcept;
  /// The kept samples no longer hold.
  void forget() noexcept { height_known_ = edge_known_ = false; }

  [[nodiscard]] const MovingRelief& relief() const noexcept { return *relief_; }
  [[nodiscard]] int left() const noexcept { return left_; }
  [[nodiscard]] int used() const noexcept { return used_; }

  /// The kept height where it is that of this point, else one more is read.
  [[nodiscard]] Height height(const Vec2& q_mm) noexcept;
  /// The edge there; it is kept.
  [[nodiscard]] EdgeSample edge(const Vec2& q_mm) noexcept;
  /// The point is within the mask.
  [[nodiscard]] bool masked(const Vec2& q_mm) noexcept;
  void keep(const Vec2& q_mm, const Height& height) noexcept;
  /// How fast the change of shape moves the edge outwards at the last sample of it, mm/s.
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
