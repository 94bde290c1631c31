// SPDX-License-Identifier: MIT
#include "tests/evaluate/report.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <stdexcept>

#include "tests/evaluate/report_check.hpp"
#include "tests/evaluate/report_csv.hpp"
#include "tests/evaluate/report_plot.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kNothing = 1e-9;  // rounding

std::ofstream opened(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw std::runtime_error("--out: cannot write " + path.string());
  return file;
}

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

std::string markdown(const std::vector<std::vector<std::string>>& lines) {
  std::string all;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string line = "|";
    std::string rule = "|";
    for (const std::string& cell : lines[i]) {
      line += " " + cell + " |";
      rule += "---|";
    }
    all += line + "\n" + (i == 0 ? rule + "\n" : "");
  }
  return all;
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

void Report::say(const std::string& text) { words_.push_back(text); }

void Report::add(const Goal& goal) {
  std::fprintf(stderr, "%-6s %-58s %10s %s (required %s)\n", goal.met() ? "ok" : "MISSED",
               goal.what.c_str(), number(goal.got).c_str(), goal.unit.c_str(),
               number(goal.required).c_str());
  goals_.push_back(goal);
}

void Report::require(const std::string& what, bool held) {
  claims_.push_back({what, "missed", 0.0, 0.0, held ? 0.0 : 1.0});
}

void Report::sayFirst(const std::string& text) { words_.insert(words_.begin(), text); }

void Report::show(const std::string& file, const std::string& caption) {
  own_pictures_ = true;
  say("![" + caption + "](" + file + ")");
}

void Report::write() const {
  writeRows(options_.out / (topic_ + ".csv"), rowsAndGoals());
  writeMarkdown();
  if (!own_pictures_) plotRows(topic_, options_.out, rows_, of_ticks_);
  if (!options_.check) return;
  const std::string failures = missedGoals() + worseFigures();
  if (!failures.empty()) throw CheckFailed(topic_ + ": --check failed" + failures);
}

// A part's goals stand for other scenes than the whole run's: they are checked, but not compared.
std::vector<Row> Report::rowsAndGoals() const {
  std::vector<Row> all = rows_;
  if (!options_.only.empty()) return all;
  for (const Goal& goal : allGoals()) all.push_back(makeRow(goal));
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

void Report::writeGoals(std::ostream& file) const {
  if (goals_.empty()) return;
  file << "| | thesis's method | required | aim | got | unit |\n|---|---|---|---|---|---|\n";
  for (const Goal& goal : goals_) {
    const char* const verdict = goal.got <= goal.aim + kNothing ? ""
                                : goal.met()                    ? " (met)"
                                                                : " **missed**";
    file << "| " << goal.what << " | " << (goal.thesis < 0 ? "-" : number(goal.thesis)) << " | "
         << number(goal.required) << " | " << number(goal.aim) << " | " << number(goal.got)
         << verdict << " | " << goal.unit << " |\n";
  }
  file << '\n';
}

void Report::writeMarkdown() const {
  std::ofstream file = opened(options_.out / (topic_ + ".md"));
  file << "## " << topic_ << "\n\n";
  for (const std::string& line : words_) file << line << "\n\n";
  writeGoals(file);
  std::vector<std::string> stages;
  for (const Row& row : rows_) {
    if (std::find(stages.begin(), stages.end(), row.stage) == stages.end())
      stages.push_back(row.stage);
  }
  for (const std::string& stage : stages) {
    std::vector<std::string> variants;
    std::vector<std::string> scenes;
    std::map<std::pair<std::string, std::string>, const Row*> cells;
    std::string unit;
    bool timed = false;
    for (const Row& row : rows_) {
      if (row.stage != stage) continue;
      unit = row.unit;
      timed = timed || row.time_us > 0;
      if (std::find(variants.begin(), variants.end(), row.variant) == variants.end())
        variants.push_back(row.variant);
      if (std::find(scenes.begin(), scenes.end(), row.scene) == scenes.end())
        scenes.push_back(row.scene);
      cells[{row.scene, row.variant}] = &row;
    }
    const char* const times = !timed ? "" : of_ticks_ ? " (us per tick)" : " (ms per frame)";
    file << "### " << stage << ", " << unit << times << "\n\n| scene |";
    for (const std::string& variant : variants) file << ' ' << variant << " |";
    file << "\n|---|";
    for (std::size_t i = 0; i < variants.size(); ++i) file << "---|";
    file << '\n';
    for (const std::string& scene : scenes) {
      file << "| " << scene << " |";
      for (const std::string& variant : variants) {
        const auto cell = cells.find({scene, variant});
        file << ' ';
        if (cell != cells.end()) {
          const std::string text = number(cell->second->error);
          file << (cell->second->is_default ? "**" + text + "**" : text);
          if (cell->second->time_us > 0)
            file << " (" << number(cell->second->time_us / (of_ticks_ ? 1.0 : 1e3)) << ')';
        }
        file << " |";
      }
      file << '\n';
    }
    file << '\n';
  }
  if (!own_pictures_) file << "![error against run time](" << topic_ << ".png)\n";
}

void writeReport(const std::filesystem::path& out, const std::vector<std::string>& topics) {
  std::ofstream file = opened(out / "report.md");
  file << "# hapticast, measured\n\nWritten by `hapticast-evaluate all`; bold is the default. "
          "Errors "
          "are against exact truth, run times of one thread.\n\n";
  for (const std::string& topic : topics) {
    const std::ifstream section(out / (topic + ".md"));
    if (section) file << section.rdbuf() << '\n';
  }
}

}  // namespace hapticast::evaluate
