// SPDX-License-Identifier: MIT
// Real captures for the topic `motion`.
#pragma once

#include <cstddef>

#include "common/geometry.hpp"
#include "server/vision/vision.hpp"
#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// A still thing in the folder of real clips, seen by a moving camera.
struct RealObject {
  const char* clip;
  const char* name;
  Vec2 point_px;  ///< on it in the first frame
  server::DepthRange range;
  std::size_t frames;  ///< in which it is seen
};

/// Velocity and acceleration of the object against the clip's camera poses; leaves a line where the
/// clip is absent.
void evaluateRealClip(Report& report, const RealObject& object, server::MotionMode mode,
                      const char* variant);

}  // namespace hapticast::evaluate
