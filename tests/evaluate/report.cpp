// SPDX-License-Identifier: MIT
#include "tests/evaluate/report.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <stdexcept>

#include "tests/evaluate/report_plot.hpp"

namespace hapticast::evaluate {

namespace {

// A field of a CSV line; none of ours has quotes in it.
std::string quoted(const std::string& text) {
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

constexpr double kNothing = 1e-9;  // rounding

std::ofstream opened(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw std::runtime_error("--out: cannot write " + path.string());
  return file;
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

void Report::sayFirst(const std::string& text) { words_.insert(words_.begin(), text); }

void Report::show(const std::string& file, const std::string& caption) {
  own_pictures_ = true;
  say("![" + caption + "](" + file + ")");
}

void Report::write() const {
  writeCsv();
  writeMarkdown();
  if (!own_pictures_) plotRows(topic_, options_.out, rows_, of_ticks_);
  const std::string missed = missedGoals();
  if (options_.check && !missed.empty()) throw std::runtime_error(topic_ + ": missed" + missed);
}

std::string Report::missedGoals() const {
  std::string out;
  for (const Goal& goal : goals_) {
    if (!goal.met())
      out += "\n  " + goal.what + ": " + number(goal.got) + ' ' + goal.unit + ", required " +
             number(goal.required);
  }
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

void Report::writeCsv() const {
  std::ofstream file = opened(options_.out / (topic_ + ".csv"));
  file << "scene,stage,variant,error,unit,time_us,is_default,is_thesis\n";
  for (const Row& row : rows_) {
    file << quoted(row.scene) << ',' << quoted(row.stage) << ',' << quoted(row.variant) << ','
         << number(row.error) << ',' << row.unit << ',' << number(row.time_us) << ','
         << row.is_default << ',' << row.is_thesis << '\n';
  }
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
