// SPDX-License-Identifier: MIT
// Rows, tables and goals of what a judge tries. Thread: one.
#pragma once

#include <string>
#include <vector>

#include "tests/evaluate/held/held_measure.hpp"
#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// Adds the trials of the results that have them. `apart` ends the names of the goals.
void reportTrials(const std::vector<held::Result>& results, const std::string& apart,
                  Report& report);

/// Adds velocity gains, and the frames without the object.
void reportGains(const std::vector<held::Result>& results, const std::string& apart,
                 Report& report);

}  // namespace hapticast::evaluate
