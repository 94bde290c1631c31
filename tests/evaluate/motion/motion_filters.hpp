// SPDX-License-Identifier: MIT
// Acceleration from tracked poses by every filter, for the topic `motion`.
#pragma once

#include <string>
#include <vector>

#include "tests/evaluate/report.hpp"
#include "tests/scenes/body_scene.hpp"

namespace hapticast::evaluate {

/// Rows `acceleration_filter`: relative rms error of each estimator x filter over one clip.
void evaluateFilters(Report& report, const std::string& name, const TestSource& source,
                     const std::vector<server::RgbdFrame>& clip);

}  // namespace hapticast::evaluate
