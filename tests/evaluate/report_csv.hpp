// SPDX-License-Identifier: MIT
// The rows of a report as a file TOPIC.csv: written by every run, read again as the baseline of a
// later one.
#pragma once

#include <filesystem>
#include <vector>

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// Writes `rows` into `file`, with the line of columns first.
/// Throws std::runtime_error naming a file that cannot be written.
void writeRows(const std::filesystem::path& file, const std::vector<Row>& rows);

/// Reads what writeRows() wrote and returns its rows; run times come back as they were.
/// Throws std::runtime_error naming the file, and the line that is no row: wrong columns, too many
/// or too few fields, no number, no flag, the same figure twice.
std::vector<Row> readRows(const std::filesystem::path& file);

}  // namespace hapticast::evaluate
