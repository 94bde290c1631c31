// SPDX-License-Identifier: MIT
// The figures of a run beside those of an earlier one, its baseline: what --check asserts. Compared
// are the rows of the defaults and what the goals got; run times never are.
#pragma once

#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// A figure may be so many times as bad as in the baseline.
inline constexpr double kMargin = 1.3;

/// Says what --check found, or why it cannot compare.
class CheckFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns whether a row is compared: it is a default's or a goal's and no run time.
[[nodiscard]] bool isCompared(const Row& row);

/// Returns the limit of a figure whose baseline this is: a margin of its size beyond it, and the
/// small absolute floor of its unit. Below the baseline for units of which more is better.
[[nodiscard]] double findLimit(const Row& baseline);

/// Returns whether `got` lies beyond the limit of `baseline`; a value that is no number does.
[[nodiscard]] bool isWorse(double got, const Row& baseline);

/// Returns the row that stands for what a goal got, in TOPIC.csv.
[[nodiscard]] Row makeRow(const Goal& goal);

/// Returns all rows of a goal: the one above, then what is required, the aim and, where there is
/// one, the thesis's result. The others are never compared.
[[nodiscard]] std::vector<Row> makeRows(const Goal& goal);

/// Returns whether `goal` was missed when the baseline was made: then missing it is no news.
[[nodiscard]] bool wasMissed(const Goal& goal, const std::vector<Row>& baseline);

/// The part of a baseline that a run can have.
struct Scope {
  std::string topic;                         ///< for the lines below
  bool whole = true;                         ///< false: a part was run, the rest is not missed
  std::set<std::string> absent_scenes = {};  ///< scenes whose clip is not on this machine
};

struct Comparison {
  std::vector<std::string> failures;  ///< a line for each figure
  std::vector<std::string> remarks;   ///< what was not compared, a line each
};

/// Compares `got` with `baseline` and returns what differs. A figure fails when it is worse than
/// its limit, when its unit has changed, or when the baseline has it and the run does not. A figure
/// without baseline is a note.
[[nodiscard]] Comparison compareRows(const Scope& scope, const std::vector<Row>& got,
                                     const std::vector<Row>& baseline);

}  // namespace hapticast::evaluate
