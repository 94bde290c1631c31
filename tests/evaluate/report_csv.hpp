// SPDX-License-Identifier: MIT
// The CSV files of a report: the rows in TOPIC.csv, which a later run reads as its baseline, and
// tables in TOPIC_NAME.csv. A field with a comma or a quotation mark is quoted.
#pragma once

#include <filesystem>
#include <vector>

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// Writes `lines` into `file`. Throws std::runtime_error naming a file that cannot be written.
void writeTable(const std::filesystem::path& file, const Table& lines);

/// Returns the lines of a table that writeTable() wrote; of a file that is absent none.
[[nodiscard]] Table readTable(const std::filesystem::path& file);

/// Writes `rows` into `file`, with the line of columns first.
/// Throws std::runtime_error naming a file that cannot be written.
void writeRows(const std::filesystem::path& file, const std::vector<Row>& rows);

/// Reads what writeRows() wrote and returns its rows; run times come back as they were.
/// Throws std::runtime_error naming the file, and the line that is no row: wrong columns, too many
/// or too few fields, no number, no flag, the same figure twice.
[[nodiscard]] std::vector<Row> readRows(const std::filesystem::path& file);

}  // namespace hapticast::evaluate
