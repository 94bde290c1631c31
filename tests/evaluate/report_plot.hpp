// SPDX-License-Identifier: MIT
// The figure of a topic: error against run time, a panel for each stage, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// Four digits are enough for people.
std::string number(double value);

/// Writes TOPIC.png into `out`: a small point for each scene, a large one for a variant's geometric
/// mean, a line through those that no other variant beats in both, a ring around the default, a
/// cross for the thesis. Rows without a run time are not drawn.
/// Run times in us per tick or in ms per frame. Says where there is no gnuplot.
void plotRows(const std::string& topic, const std::filesystem::path& out,
              const std::vector<Row>& rows, bool of_ticks);

}  // namespace hapticast::evaluate
