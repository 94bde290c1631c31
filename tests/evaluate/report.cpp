// SPDX-License-Identifier: MIT
#include "tests/evaluate/report.hpp"

#include <cstdarg>
#include <cstdio>
#include <stdexcept>

#include "tests/evaluate/report_check.hpp"
#include "tests/evaluate/report_csv.hpp"
#include "tests/evaluate/report_plot.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

namespace {

std::vector<Row> readBaseline(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    throw CheckFailed("--check: there is no baseline " + file.string() +
                      " (--baseline names its folder)");
  }
  try {
    return readRows(file);
  } catch (const std::runtime_error& error) {
    throw CheckFailed(std::string("--check: ") + error.what());
  }
}

}  // namespace

std::string text(const char* pattern, ...) {
  char buffer[512];
  va_list values;
  va_start(values, pattern);
  std::vsnprintf(buffer, sizeof buffer, pattern, values);
  va_end(values);
  return buffer;
}

Report::Report(std::string topic, Options options)
    : topic_(std::move(topic)), options_(std::move(options)) {
  std::error_code error;
  std::filesystem::create_directories(options_.out, error);
  if (error) {
    throw std::runtime_error("--out " + options_.out.string() +
                             ": cannot be made: " + error.message());
  }
  if (options_.check) baseline_ = readBaseline(options_.baseline / (topic_ + ".csv"));
}

void Report::add(Row row) {
  std::fprintf(stderr, "%-12s %-14s %-22s %10s %-10s %8.3g us\n", row.stage.c_str(),
               row.scene.c_str(), row.variant.c_str(), number(row.error).c_str(), row.unit.c_str(),
               row.time_us);
  rows_.push_back(std::move(row));
}

void Report::add(const Goal& goal) {
  std::fprintf(stderr, "%-6s %-58s %10s %s (required %s)\n", goal.met() ? "ok" : "MISSED",
               goal.what.c_str(), number(goal.got).c_str(), goal.unit.c_str(),
               number(goal.required).c_str());
  goals_.push_back(goal);
}

void Report::require(const std::string& claim, const std::string& required, const std::string& got,
                     bool held) {
  std::fprintf(stderr, "%-6s %s: got %s (required %s)\n", held ? "ok" : "MISSED", claim.c_str(),
               got.c_str(), required.c_str());
  claims_.push_back({claim, "missed", 0.0, 0.0, held ? 0.0 : 1.0});
  addTable("claims", {{"claim", "required", "got"}, {claim, required, got}});
}

void Report::addTable(const std::string& name, const Table& lines) {
  Table& table = tables_[name];
  table.insert(table.end(), lines.begin() + (table.empty() ? 0 : 1), lines.end());
}

void Report::leaveOut(const std::string& scene) {
  std::fprintf(stderr, "note: %s; %s: left out, its clip is absent (HAPTICAST_CLIPS: the folder)\n",
               topic_.c_str(), scene.c_str());
  absent_.insert(scene);
}

void Report::write() const {
  writeRows(options_.out / (topic_ + ".csv"), rowsAndGoals());
  for (const auto& [name, lines] : tables_)
    writeTable(options_.out / (topic_ + "_" + name + ".csv"), lines);
  const auto known = topics().find(topic_);
  if (known == topics().end() || known->second.pictures.empty())
    plotRows(topic_, options_.out, rows_, of_ticks_);
  if (!options_.check) return;
  const std::string failures = missedGoals() + worseFigures();
  if (!failures.empty()) throw CheckFailed(topic_ + ": --check failed" + failures);
}

// A part's goals stand for other scenes than the whole run's: they are checked, but not compared.
std::vector<Row> Report::rowsAndGoals() const {
  std::vector<Row> all = rows_;
  if (!options_.only.empty()) return all;
  for (const Goal& goal : allGoals()) {
    for (const Row& row : makeRows(goal)) all.push_back(row);
  }
  return all;
}

std::vector<Goal> Report::allGoals() const {
  std::vector<Goal> all = goals_;
  all.insert(all.end(), claims_.begin(), claims_.end());
  return all;
}

std::string Report::missedGoals() const {
  std::string out;
  for (const Goal& goal : allGoals()) {
    if (goal.met()) continue;
    const std::string line = topic_ + "; " + goal.what + ": got " + number(goal.got) + ' ' +
                             goal.unit + ", required " + number(goal.required);
    if (wasMissed(goal, baseline_)) {
      std::fprintf(stderr, "note: %s, missed in the baseline, too\n", line.c_str());
    } else {
      out += "\n  " + line;
    }
  }
  return out;
}

std::string Report::worseFigures() const {
  const Comparison found =
      compareRows({topic_, options_.only.empty(), absent_}, rowsAndGoals(), baseline_);
  for (const std::string& remark : found.remarks)
    std::fprintf(stderr, "note: %s\n", remark.c_str());
  std::string out;
  for (const std::string& failure : found.failures) out += "\n  " + failure;
  return out;
}

}  // namespace hapticast::evaluate
