// SPDX-License-Identifier: MIT
// Real captures for the topic `motion`.
#pragma once

#include "common/geometry.hpp"
#include "server/vision/vision.hpp"
#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// One object of the clip visp_rbt_desk, by a point on it in the first frame; leaves a line where
/// the clip is absent.
void evaluateDesk(Report& report, const char* name, const Vec2& object_px, server::MotionMode mode,
                  const char* variant);

}  // namespace hapticast::evaluate
