// SPDX-License-Identifier: MIT
// The relief of one object at play time, in the object's own frame. The origin of that frame is the
// reference point, and its axes turn with the object.
//
// The reliefs of the two frames around play time are transformed into the object's frame, and
// blended there. So a rigid motion has no effect on the blend:
//   H_t(q) = (1-s) (H_a(q + p_a) - p_a,z) + s (H_b(q + p_b) - p_b,z)
// H_a and H_b are the heights in the frames a and b. p_a and p_b are the positions of the reference
// point in these frames, and s is the blend. The formula omits the rotation. The same formula holds
// for the edge distance. The two terms in brackets do not depend on s. So a cached sample stays
// valid until the pair of frames changes, although s changes in every tick.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstddef>

#include "client/haptics/playback/scene.hpp"

namespace hapticast::client {

/// Height (mm) and its derivatives (mm/mm, 1/mm) at a point of the object.
struct BlendedHeight {
  double height_mm = 0.0;
  Vec2 gradient = Vec2::Zero();
  double bend_xx = 0.0;
  double bend_xy = 0.0;
  double bend_yy = 0.0;
};

/// The blended relief of one object (see the head of this file).
class MovingRelief {
 public:
  /// Stores the two frames of `object` around play time, and their blend. Returns true if the two
  /// frames differ from the last ones, so that all earlier samples are invalid. Two frames with the
  /// same relief at the same position and angle count as one frame. Requires that
  /// object.before->field exists and is not empty. The frames must outlive the next update().
  bool update(const InterpolatedObject& object, const Workspace& workspace) noexcept;

  /// The samples of both frames at one point. If both frames count as one (update()), only `first`
  /// is valid.
  template <class Value>
  struct Pair {
    Value first, second;
  };
  using Heights = Pair<BlendedHeight>;
  using Edges = Pair<EdgeSample>;
  /// Samples the heights of both frames at `q_mm`.
  [[nodiscard]] Heights heights(const Vec2& q_mm) const noexcept;
  /// Samples the edge distances of both frames at `q_mm`.
  [[nodiscard]] Edges edges(const Vec2& q_mm) const noexcept;

  /// Return the blend of the two samples of `pair` at play time.
  [[nodiscard]] BlendedHeight now(const Heights& pair) const noexcept;
  [[nodiscard]] EdgeSample now(const Edges& pair) const noexcept;
  /// Return the speed (mm/s) at which the change of the shape moves the surface at the point of
  /// `pair`: upwards for heights, outwards for edges.
  [[nodiscard]] double rate_mm_s(const Heights& pair) const noexcept;
  [[nodiscard]] double rate_mm_s(const Edges& pair) const noexcept;

  /// Returns an upper bound of the heights of the relief, mm, in the object's frame.
  [[nodiscard]] double highest_mm() const noexcept { return highest_mm_; }
  /// Returns true if the segment from `a_mm` to `b_mm` certainly does not cross the mask. False
  /// means that it may cross the mask.
  [[nodiscard]] bool isAside(const Vec2& a_mm, const Vec2& b_mm) const noexcept;
  /// Returns the smaller side of a pixel, mm.
  [[nodiscard]] double pixel_mm() const noexcept { return pixel_mm_; }

 private:
  /// One frame, with the transform from the object's frame into its picture.
  struct Frame {
    const HeightField* field = nullptr;
    Vec3 position_mm = Vec3::Zero();
    double angle_rad = 0.0;
    // The image position of a point q of the object is origin_px + (u · q, v · q), in px.
    Vec2 origin_px = Vec2::Zero();
    Vec2 u = Vec2::Zero();
    Vec2 v = Vec2::Zero();
    Vec2 rotation_rad = Vec2::UnitX();  // cosine and sine of angle_rad

    [[nodiscard]] bool isSame(const PlayObject& object) const noexcept;
    void set(const PlayObject& object, const Workspace& workspace) noexcept;
    [[nodiscard]] Vec2 toImage(const Vec2& q_mm) const noexcept {
      return origin_px + Vec2(u.dot(q_mm), v.dot(q_mm));
    }
    [[nodiscard]] BlendedHeight height(const Vec2& q_mm) const noexcept;
    [[nodiscard]] EdgeSample edge(const Vec2& q_mm) const noexcept;
    [[nodiscard]] bool isAside(const Vec2& a_mm, const Vec2& b_mm) const noexcept;
  };

  // The relief is a blend of both frames if two_ is set; otherwise only first_ counts.
  Frame first_, second_;
  bool two_ = false;
  double blend_ = 0.0;
  double blend_rate_1_s_ = 0.0;
  double highest_mm_ = 0.0;
  double pixel_mm_ = 1.0;
};

}  // namespace hapticast::client
