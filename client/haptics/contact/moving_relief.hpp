// SPDX-License-Identifier: MIT
// One object's relief as the proxy sees it: in the object's own frame (origin at the reference
// point, turned with the object), between the frames around play time. Real-time room.
#pragma once

#include <cstddef>

#include "client/haptics/playback/scene.hpp"

namespace hapticast::client {

/// Height and its derivatives at a point of the object (mm, mm/mm, 1/mm).
struct BlendedHeight {
  double height_mm = 0.0;
  Vec2 gradient = Vec2::Zero();
  double bend_xx = 0.0;
  double bend_xy = 0.0;
  double bend_yy = 0.0;
};

/// The relief does not contain the pose at play time: rigid motion never touches it, only what the
/// two frames differ in when each is carried back to the object's own frame:
/// H_t(q) = (1-s) (H_a(q + p_a) - p_a,z) + s (H_b(q + p_b) - p_b,z), and the same for the distance
/// to the edge, with the blend s and the poses p of the frames a and b. So a sample's two parts
/// hold as long as the pair of frames does, and only the blend s changes.
class MovingRelief {
 public:
  /// Takes over pair and blend; true if the pair is another one than before, so that samples no
  /// longer hold. Frames that show the same relief at the same place are taken as one.
  /// Requires object.before->field, not empty.
  bool update(const InterpolatedObject& object, const Workspace& workspace) noexcept;

  /// What both frames have at one point; `second` is unused where one frame stands for all.
  template <class Value>
  struct Pair {
    Value first, second;
  };
  using Heights = Pair<BlendedHeight>;
  using Edges = Pair<EdgeSample>;
  [[nodiscard]] Heights heights(const Vec2& q_mm) const noexcept;
  [[nodiscard]] Edges edges(const Vec2& q_mm) const noexcept;

  /// A pair of samples at play time.
  [[nodiscard]] BlendedHeight now(const Heights& pair) const noexcept;
  [[nodiscard]] EdgeSample now(const Edges& pair) const noexcept;
  /// How fast the change of shape raises the surface, or moves the edge outwards, mm/s.
  [[nodiscard]] double rate_mm_s(const Heights& pair) const noexcept;
  [[nodiscard]] double rate_mm_s(const Edges& pair) const noexcept;

  /// Nothing of the relief is higher (object's frame).
  [[nodiscard]] double highest_mm() const noexcept { return highest_mm_; }
  /// The way between two points is clear of the mask's rectangle, whatever the heights.
  [[nodiscard]] bool aside(const Vec2& a_mm, const Vec2& b_mm) const noexcept;
  /// The smaller side of a pixel.
  [[nodiscard]] double pixel_mm() const noexcept { return pixel_mm_; }

 private:
  struct Frame {
    const HeightField* field = nullptr;
    Vec3 position_mm = Vec3::Zero();
    double angle_rad = 0.0;
    // image px = origin + (u · q, v · q): carried to the frame's pose and into its picture.
    Vec2 origin_px = Vec2::Zero();
    Vec2 u = Vec2::Zero();
    Vec2 v = Vec2::Zero();
    Vec2 rotation_rad = Vec2::UnitX();  // cosine and sine of angle_rad

    [[nodiscard]] bool same(const PlayObject& object) const noexcept;
    void set(const PlayObject& object, const Workspace& workspace) noexcept;
    [[nodiscard]] Vec2 toImage(const Vec2& q_mm) const noexcept {
      return origin_px + Vec2(u.dot(q_mm), v.dot(q_mm));
    }
    [[nodiscard]] BlendedHeight height(const Vec2& q_mm) const noexcept;
    [[nodiscard]] EdgeSample edge(const Vec2& q_mm) const noexcept;
    [[nodiscard]] bool aside(const Vec2& a_mm, const Vec2& b_mm) const noexcept;
  };

  Frame first_, second_;
  bool two_ = false;
  double blend_ = 0.0;
  double blend_rate_1_s_ = 0.0;
  double highest_mm_ = 0.0;
  double pixel_mm_ = 1.0;
};

}  // namespace hapticast::client
