// SPDX-License-Identifier: MIT
// The page that people read: report.md, made of the CSV files of a folder.
#pragma once

#include <filesystem>

namespace hapticast::evaluate {

/// Writes `out`/report.md: for each topic of topics() that has a TOPIC.csv in `out` a paragraph, a
/// table of at most kMostLines lines and its pictures that are there. Goals that are missed come
/// first, then those that are nearest to their limit. A topic without goals has means of its
/// stages. Throws std::runtime_error naming a file that cannot be read or written.
void writeReport(const std::filesystem::path& out);

/// Lines of a topic's table.
inline constexpr std::size_t kMostLines = 8;

}  // namespace hapticast::evaluate
