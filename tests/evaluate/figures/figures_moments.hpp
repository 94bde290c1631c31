// SPDX-License-Identifier: MIT
// Static and total force of a scripted hand over time, for the thesis's figures.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/evaluate/curves.hpp"
#include "tests/evaluate/touch/touch_player.hpp"
#include "tests/scenes/relief_scene.hpp"

namespace hapticast::evaluate {

inline constexpr const char* kStaticColor = "#2a78d6";
inline constexpr const char* kTotalColor = "#d1495b";

struct Moment {
  double time_s = 0.0;
  Vec3 static_N = Vec3::Zero(), total_N = Vec3::Zero();
  Vec3 true_static_N = Vec3::Zero(), true_total_N = Vec3::Zero();
};

/// Acceleration of the scripted hand, m/s².
using HandAcceleration = std::function<Vec3(double time_s)>;

/// A hand whose positions come in the device's counts. `body`: exact motion of what it touches, for
/// the truth of the total force; null: not known.
std::vector<Moment> forcesOf(const Stream& stream, const Variant& variant, const Hand& hand,
                             const HandAcceleration& hand_m_s2, const MotionAt& body);

/// Rms of the error over rms of the truth, %.
double errorOf(const std::vector<Moment>& moments, Vec3 Moment::*what, Vec3 Moment::*truth);

/// Force arrows at places of a ball's slice.
struct SliceArrows {
  std::string name, color;
  double width = 1.5;
  std::vector<std::pair<Vec3, Vec3>>
      forces;  ///< place relative to the ball's centre (mm), force (N)
};

/// The upper half of a ball in the plane of `axis` (0: x, 1: y) and z, with arrows of 10 mm for 1
/// N.
CurvePanel slicePanel(const std::string& title, int axis, double radius_mm,
                      const std::vector<SliceArrows>& arrows);

/// Static and total force in one direction over time.
CurvePanel forcePanel(const std::vector<Moment>& moments, int axis, const std::string& title);

}  // namespace hapticast::evaluate
