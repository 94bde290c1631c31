// SPDX-License-Identifier: MIT
// Scenes that are touched: a picture with depth for the server, and for the hand the exact surface
// at any instant. A ReliefSource shows a body given by a formula in nominal mm, from so far away
// that the picture is a parallel projection: what the formula says is the truth. Thread: one.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/haptic_frame.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/synthetic/synthetic_scene.hpp"

namespace hapticast::evaluate {

/// Of every scene, as in the thesis.
inline constexpr double kSceneFps = 25.0;

/// Height (nominal mm) over a point at a time; NaN beside the body.
using HeightAt = std::function<double(const Vec2& nominal_mm, double time_s)>;
using MotionAt = std::function<Motion(double time_s)>;

/// The origin of the source's depth and mask.
struct Seen {
  bool eight_bit = true;  ///< 255 levels over the mapped 30 mm; else float
  bool give_mask = true;  ///< the exact one
};

struct TouchScene {
  std::string name;
  double duration_s = 4.0;
  HeightAt height_mm;
  MotionAt motion;  ///< of the body's reference point, exact
  std::function<std::unique_ptr<server::RgbdSource>(const Seen&)> open;

  /// Where the picture shows the body in its first frame, px.
  [[nodiscard]] Vec2 objectPoint_px() const;
};

/// A body in its own frame: origin at its reference point, axes as the nominal frame's at angle 0.
struct ReliefBody {
  std::string name;
  HeightAt height_mm;      ///< over the reference point's z; NaN beside the body
  double reach_mm = 30.0;  ///< no part of it is farther from its origin
  double duration_s = 4.0;
  MotionAt motion;
  bool still = false;  ///< every frame is the first one
};

/// The body as a scene, 640 x 480, 25 frames per second.
TouchScene reliefScene(const ReliefBody& body);

Vec2 turned(const Vec2& v, double angle_rad);

/// Gradient (mm/mm) of a height by central differences: exact enough for any smooth formula.
Vec2 gradientOf(const HeightAt& height_mm, const Vec2& nominal_mm, double time_s);

}  // namespace hapticast::evaluate
