// SPDX-License-Identifier: MIT
// The output of every topic of hapticast-evaluate: TOPIC.csv, a plot TOPIC.png, a section of
// report.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <set>
#include <string>
#include <vector>

namespace hapticast::evaluate {

/// printf to a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* pattern, ...);

/// A table in Markdown: the first line is the heading.
std::string markdown(const std::vector<std::vector<std::string>>& lines);

/// One measurement; a line of the CSV (README.md).
struct Row {
  std::string scene;
  std::string stage;    ///< mask, relief, velocity, acceleration, impact, force, ...
  std::string variant;  ///< which choice of the stage
  double error = 0.0;
  std::string unit;
  double time_us = 0.0;  ///< per frame (server) or tick (client)
  bool is_default = false;
  bool is_thesis = false;
};

/// Required and measured value. Smaller is better.
struct Goal {
  std::string what;
  std::string unit;
  double required = 0.0;
  double aim = 0.0;
  double got = 0.0;
  double thesis = -1.0;  ///< the thesis's own method in the same case; < 0: it has none

  [[nodiscard]] bool met() const { return got <= required; }  // a NaN is not
};

struct Options {
  std::filesystem::path out = "evaluate";
  bool quick = false;
  bool check = false;  ///< a missed requirement or a figure worse than its baseline is an error
  std::filesystem::path baseline;  ///< folder of the baselines TOPIC.csv that `check` reads
  std::string only;       ///< of the scenes of `motion` or the parts of `network`, `stability` and
                          ///< `vision`, the one of this name; empty: all
  std::uint64_t set = 1;  ///< which draw of the held scenes of `vision`
};

class Report {
 public:
  /// Makes the folder `out`. Throws std::runtime_error where it cannot be made, and, if figures are
  /// to be checked, CheckFailed where the baseline is missing or cannot be read.
  Report(std::string topic, Options options);
  /// Also says it on stderr, so that long work shows progress.
  void add(Row row);
  /// Lines of report.md; rows are put into tables by stage after it.
  void say(const std::string& text);
  /// A line of the table of requirements, and of what is checked.
  void add(const Goal& goal);
  /// Adds a requirement that is no figure, for the check alone: a goal of 0, of which 1 is got
  /// where it is not `held`.
  void require(const std::string& what, bool held);
  /// Says that the clip of this scene is not on this machine: its baseline is not asked for.
  void leaveOut(const std::string& scene) { absent_.insert(scene); }
  /// Run times are of a tick of the client, not of a frame, in us.
  void timesAreOfTicks() { of_ticks_ = true; }
  void sayFirst(const std::string& text);
  /// A picture that the topic made itself in the report's folder, instead of the one of errors
  /// against run time.
  void show(const std::string& file, const std::string& caption);
  /// Writes the files; plots with gnuplot where there is one, else says that there is none. Throws
  /// std::runtime_error naming the file that cannot be written. If figures are to be checked, then
  /// throws CheckFailed with the requirements that were missed and the figures that got worse
  /// (after the files are written).
  void write() const;
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

 private:
  void writeMarkdown() const;
  void writeGoals(std::ostream& file) const;
  [[nodiscard]] std::vector<Row> rowsAndGoals() const;
  [[nodiscard]] std::vector<Goal> allGoals() const;
  [[nodiscard]] std::string missedGoals() const;
  [[nodiscard]] std::string worseFigures() const;

  std::string topic_;
  Options options_;
  std::vector<Row> rows_;
  std::vector<std::string> words_;
  std::vector<Goal> goals_;
  std::vector<Goal> claims_;
  std::vector<Row> baseline_;
  std::set<std::string> absent_;
  bool of_ticks_ = false;
  bool own_pictures_ = false;
};

/// report.md: the sections of all topics that have one in `out`.
void writeReport(const std::filesystem::path& out, const std::vector<std::string>& topics);

}  // namespace hapticast::evaluate
