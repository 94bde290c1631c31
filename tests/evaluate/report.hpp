// SPDX-License-Identifier: MIT
// The output of every topic of hapticast-evaluate: TOPIC.csv, tables TOPIC_NAME.csv, a plot
// TOPIC.png.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace hapticast::evaluate {

/// printf to a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* pattern, ...);

/// Lines of cells; the first line is the heading.
using Table = std::vector<std::vector<std::string>>;

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
  /// Adds a goal to what is checked.
  void add(const Goal& goal);
  /// Adds a requirement in words to TOPIC_claims.csv, and for the check a goal of 0, of which 1 is
  /// got where it is not `held`.
  void require(const std::string& claim, const std::string& required, const std::string& got,
               bool held);
  /// Adds the lines of a table to TOPIC_NAME.csv. A later table of the same name has the same
  /// heading, and its lines follow.
  void addTable(const std::string& name, const Table& lines);
  /// Says that the clip of this scene is not on this machine: its baseline is not asked for.
  void leaveOut(const std::string& scene);
  /// Run times are of a tick of the client, not of a frame, in us.
  void timesAreOfTicks() { of_ticks_ = true; }
  /// Writes the files; plots with gnuplot where there is one, else says that there is none. Throws
  /// std::runtime_error naming the file that cannot be written. If figures are to be checked, then
  /// throws CheckFailed with the requirements that were missed and the figures that got worse
  /// (after the files are written).
  void write() const;
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

 private:
  [[nodiscard]] std::vector<Row> rowsAndGoals() const;
  [[nodiscard]] std::vector<Goal> allGoals() const;
  [[nodiscard]] std::string missedGoals() const;
  [[nodiscard]] std::string worseFigures() const;

  std::string topic_;
  Options options_;
  std::vector<Row> rows_;
  std::vector<Goal> goals_;
  std::vector<Goal> claims_;
  std::map<std::string, Table> tables_;
  std::vector<Row> baseline_;
  std::set<std::string> absent_;
  bool of_ticks_ = false;
};

}  // namespace hapticast::evaluate
