// SPDX-License-Identifier: MIT
#include "tests/evaluate/report_page.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "tests/evaluate/report_csv.hpp"
#include "tests/evaluate/report_plot.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

namespace {

constexpr std::size_t kParagraphWidth = 116;  // columns
constexpr const char* kHeading =
    "| | required | aim | got | thesis's method | unit |\n|---|---|---|---|---|---|\n";
using Value = std::optional<double>;

// A goal as TOPIC.csv has it: a row for each of its values.
struct PageGoal {
  std::string what, unit;
  std::map<std::string, double> values;  // by variant: required, aim, got, thesis

  [[nodiscard]] Value find(const char* variant) const {
    const auto found = values.find(variant);
    return found == values.end() ? Value() : Value(found->second);
  }
  // Older files have no row of it.
  [[nodiscard]] bool missed() const {
    const Value required = find("required");
    return required && !(find("got") <= required);
  }
  // got / required
  [[nodiscard]] double ratio() const {
    const double got = find("got").value_or(std::nan(""));
    if (got == 0.0) return 0.0;
    const double ratio = got / find("required").value_or(1.0);
    return std::isnan(ratio) ? std::numeric_limits<double>::infinity() : ratio;
  }
};

struct Page {
  std::string overview;  // lines of the table of topics
  std::string sections;
};

template <class Found>
auto& findOrAppend(std::vector<Found>& all, const std::string& name, std::string Found::*key) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Found& one) { return one.*key == name; });
  if (found != all.end()) return *found;
  all.emplace_back();
  all.back().*key = name;
  return all.back();
}

std::string escapeCell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? "\\|" : std::string(1, c);
  return out;
}

std::string show(const Value& value) { return value ? number(*value) : "-"; }

std::string makeLine(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += (cell.empty() ? "" : " " + cell) + " |";
  return line + '\n';
}

std::string wrapText(const std::string& text) {
  std::istringstream words(text);
  std::string out;
  std::size_t used = 0;
  for (std::string word; words >> word; used += word.size() + 1) {
    if (used > 0 && used + word.size() > kParagraphWidth) {
      out += '\n';
      used = 0;
    }
    out += (used > 0 ? " " : "") + word;
  }
  return out + '\n';
}

std::vector<PageGoal> selectGoals(const std::vector<Row>& rows) {
  std::vector<PageGoal> goals;
  for (const Row& row : rows) {
    if (row.stage != "goal") continue;
    PageGoal& goal = findOrAppend(goals, row.scene, &PageGoal::what);
    goal.unit = row.unit;
    goal.values[row.variant] = row.error;
  }
  std::stable_sort(goals.begin(), goals.end(), [](const PageGoal& a, const PageGoal& b) {
    return std::pair(b.missed(), b.ratio()) < std::pair(a.missed(), a.ratio());
  });
  return goals;
}

// Claims have their words for what is required and what was got.
std::string makeGoalLine(const PageGoal& goal, const Table& claims) {
  const auto mark = [&goal](const std::string& text) {
    return goal.missed() ? std::string("**").append(text).append("**") : text;
  };
  for (const std::vector<std::string>& claim : claims) {
    if (claim.size() != 3 || claim[0] != goal.what) continue;
    return makeLine(
        {escapeCell(goal.what), escapeCell(claim[1]), "-", mark(escapeCell(claim[2])), "-", ""});
  }
  return makeLine({escapeCell(goal.what), show(goal.find("required")), show(goal.find("aim")),
                   mark(show(goal.find("got"))), show(goal.find("thesis")), goal.unit});
}

// A mean over the scenes, by variant of a stage: geometric, or rms where a value is 0.
struct Stage {
  std::string name, unit;
  std::map<std::string, double> ours, theirs;  // by scene

  [[nodiscard]] std::string line() const {
    bool rms = false;
    for (const auto* errors : {&ours, &theirs}) {
      for (const auto& [scene, error] : *errors) rms = rms || !(error > 0.0);
    }
    return makeLine({escapeCell(name) + (rms ? " (rms)" : ""), "-", "-", show(mean(ours, rms)),
                     show(mean(theirs, rms)), unit});
  }

  // Where the thesis's method has errors, the scenes of both count alone.
  void keepCommon() {
    if (theirs.empty()) return;
    std::erase_if(ours, [&](const auto& one) { return !theirs.contains(one.first); });
    std::erase_if(theirs, [&](const auto& one) { return !ours.contains(one.first); });
  }

 private:
  static Value mean(const std::map<std::string, double>& errors, bool rms) {
    if (errors.empty()) return {};
    double sum = 0.0;
    for (const auto& [scene, error] : errors) sum += rms ? error * error : std::log(error);
    sum /= double(errors.size());
    return rms ? std::sqrt(sum) : std::exp(sum);
  }
};

std::vector<Stage> selectStages(const std::vector<Row>& rows) {
  std::vector<Stage> stages;
  for (const Row& row : rows) {
    if (row.stage == "goal" || !(row.is_default || row.is_thesis)) continue;
    Stage& stage = findOrAppend(stages, row.stage, &Stage::name);
    stage.unit = row.unit;
    (row.is_default ? stage.ours : stage.theirs)[row.scene] = row.error;
  }
  for (Stage& stage : stages) stage.keepCommon();
  std::stable_partition(stages.begin(), stages.end(), [](const Stage& stage) {
    return !stage.ours.empty() && !stage.theirs.empty();
  });
  return stages;
}

// What the table of a topic leaves out: "3 more goals met, 1 more goals missed: LINK".
std::string describeRest(const std::vector<std::pair<std::size_t, std::string>>& rest,
                         const std::string& link) {
  std::string text;
  for (const auto& [count, what] : rest) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " more " + what;
  }
  return (text.empty() ? "All rows" : text) + ": [" + link + "](" + link + ").\n";
}

std::string makePictures(const std::filesystem::path& out, const std::string& name) {
  std::vector<Picture> pictures = topics().at(name).pictures;
  if (pictures.empty()) pictures = {{name + ".png", "error against run time; ring: default"}};
  std::string text;
  for (const Picture& picture : pictures) {
    if (std::filesystem::exists(out / picture.file))
      text += "![" + picture.caption + "](" + picture.file + ")\n";
  }
  return text.empty() ? text : '\n' + text;
}

// Returns the table of a topic without goals.
std::string makeStages(const std::vector<Row>& rows, const std::string& name) {
  const std::vector<Stage> stages = selectStages(rows);
  const std::size_t shown = std::min(stages.size(), kMostLines);
  std::string text = kHeading;
  for (std::size_t i = 0; i < shown; ++i) text += stages[i].line();
  return text + "\nNo goals: the table has means over the scenes. " +
         describeRest({{stages.size() - shown, "stages"}}, name + ".csv");
}

std::string makeGoals(const std::vector<PageGoal>& goals, std::size_t missed,
                      const std::filesystem::path& out, const std::string& name) {
  const std::size_t shown = std::min(goals.size(), kMostLines);
  const Table claims = readTable(out / (name + "_claims.csv"));
  std::string text = kHeading;
  for (std::size_t i = 0; i < shown; ++i) text += makeGoalLine(goals[i], claims);
  const std::string link = name + (claims.empty() ? ".csv" : "_claims.csv");
  if (!goals.front().find("required"))
    return text + "\nAn older file. " + describeRest({{goals.size() - shown, "goals"}}, link);
  const std::size_t hidden = missed > shown ? missed - shown : 0;
  return text + '\n' +
         describeRest({{hidden, "goals missed"}, {goals.size() - shown - hidden, "goals met"}},
                      link);
}

void addTopic(Page& page, const std::filesystem::path& out, const std::string& name) {
  const std::vector<Row> rows = readRows(out / (name + ".csv"));
  const std::vector<PageGoal> goals = selectGoals(rows);
  const auto missed = static_cast<std::size_t>(
      std::count_if(goals.begin(), goals.end(), [](const PageGoal& g) { return g.missed(); }));
  const bool known = !goals.empty() && goals.front().find("required");
  const Topic& topic = topics().at(name);
  page.overview += makeLine({"[" + name + "](#" + name + ")",
                             known ? std::to_string(goals.size() - missed) : "-",
                             known ? std::to_string(missed) : "-", topic.about});
  page.sections += "\n## " + name + "\n\n" + wrapText(topic.method) + '\n' +
                   (goals.empty() ? makeStages(rows, name) : makeGoals(goals, missed, out, name)) +
                   makePictures(out, name);
}

}  // namespace

void writeReport(const std::filesystem::path& out) {
  Page page;
  for (const auto& [name, topic] : topics()) {
    if (std::filesystem::exists(out / (name + ".csv"))) addTopic(page, out, name);
  }
  const std::filesystem::path path = out / "report.md";
  std::ofstream file(path);
  file << "# hapticast, measured\n\n`hapticast-evaluate report --out DIR` makes this page of the "
          "CSV files of its folder. Errors are against exact truth.\nSmaller is better. Bold: the "
          "goal is missed. The README of tests/evaluate defines goals, stages and units.\n\n"
          "| topic | goals met | missed | what |\n|---|---|---|---|\n"
       << page.overview << page.sections;
  if (!file.flush()) throw std::runtime_error("--out: cannot write " + path.string());
}

}  // namespace hapticast::evaluate
