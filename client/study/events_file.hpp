// SPDX-License-Identifier: MIT
// The events file of a subject (BIDS *_events.tsv): one row per ended trial. It is the journal of
// the study as well: a row is on the disk before the next trial begins, and --resume reads the rows
// again. A last row without its line end belongs to an interrupted write, and is dropped.
// Thread: one.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"

namespace hapticast::client {

/// One ended trial. Absent values are "n/a" in the file.
struct TrialRow {
  double onset_s = 0.0;     ///< since the first row of the motion file
  double duration_s = 0.0;  ///< from the onset to the answer
  bool is_training = false;
  std::size_t trial = 1;                                  ///< Trial::number
  std::string condition{};                                ///< its code
  std::optional<int> comparison_interval = std::nullopt;  ///< 1 or 2, of a forced choice
  std::optional<double> level = std::nullopt;
  std::optional<double> answer = std::nullopt;  ///< absent: the trial is void
  std::optional<bool> is_correct = std::nullopt;
  std::optional<double> response_time_s = std::nullopt;  ///< from the question to the answer
  std::string status = "valid";                          ///< or why the trial is void, in one word
  std::string wall_clock{};                              ///< of the onset, ISO 8601 in UTC
  bool operator==(const TrialRow&) const = default;
};

/// A column: its name, and its description for BIDS.
struct EventColumn {
  const char* name;
  const char* description;
};
/// Returns the columns, in order.
[[nodiscard]] const std::vector<EventColumn>& listEventColumns();

/// Returns the row as a line with its end.
[[nodiscard]] std::string toLine(const TrialRow& row);
/// Returns the row in a line without its end.
[[nodiscard]] Result<TrialRow> parseRow(std::string_view line);

class EventsFile {
 public:
  /// Creates `file`, or opens it again if `resume` is true, and locks it. Throws
  /// std::runtime_error with one line: the file exists and `resume` is false, it does not exist and
  /// `resume` is true, another program has it, it has a wrong row, or it cannot be written.
  EventsFile(const std::filesystem::path& file, bool resume);
  ~EventsFile();
  EventsFile(const EventsFile&) = delete;
  EventsFile& operator=(const EventsFile&) = delete;

  /// Returns the rows that were there at the opening.
  [[nodiscard]] const std::vector<TrialRow>& rows() const { return rows_; }
  /// Appends a row, and waits until it is on the disk. Throws std::runtime_error with one line.
  void append(const TrialRow& row);

 private:
  void restore();
  void write(std::string_view text);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::vector<TrialRow> rows_;
};

}  // namespace hapticast::client
