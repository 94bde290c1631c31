// SPDX-License-Identifier: MIT
// report.md from the CSV files of a folder: what it has of each topic, and how long it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/evaluate/report_page.hpp"
#include "tests/evaluate/topics.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::evaluate {

namespace {

/// The topics of a test, which the program forgets after it.
struct PageTopics {
  explicit PageTopics(const std::vector<std::string>& names) {
    for (const std::string& name : names) topics()[name] = {"about", name + " against the truth."};
  }
  ~PageTopics() { topics().clear(); }
};

std::string readPage(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string makePage(const std::filesystem::path& folder) {
  writeReport(folder);
  return readPage(folder / "report.md");
}

Report makeReport(const TempFolder& folder, const std::string& topic) {
  Options options;
  options.out = folder / "";
  return {topic, options};
}

bool has(const std::string& page, const std::string& part) {
  return page.find(part) != std::string::npos;
}

long countLines(const std::string& page) { return std::count(page.begin(), page.end(), '\n'); }

}  // namespace

TEST(ReportPage, ShowsMissedGoalsFirstAndThenThoseNearTheirLimit) {
  const TempFolder folder;
  const PageTopics registered({"probe"});
  Report report = makeReport(folder, "probe");
  for (int i = 0; i < 12; ++i) report.add(Goal{text("goal %d", i), "%", 10, 1, 0.1 * i, 50});
  report.add(Goal{"worst | of it", "mm", 2, 1, 2.5});
  report.write();
  const std::string page = makePage(folder / "");
  EXPECT_TRUE(has(page, "probe against the truth."));
  EXPECT_TRUE(has(page,
                  "|---|---|---|---|---|---|\n| worst \\| of it | 2 | 1 | **2.5** | - | mm |\n"
                  "| goal 11 | 10 | 1 | 1.1 | 50 | % |\n| goal 10 |"));
  EXPECT_FALSE(has(page, "| goal 2 |"));
  EXPECT_TRUE(has(page, "5 more goals met: [probe.csv](probe.csv)."));
  EXPECT_TRUE(has(page, "| [probe](#probe) | 12 | 1 | about |"));
}

TEST(ReportPage, ShowsClaimsInTheirWords) {
  const TempFolder folder;
  const PageTopics registered({"probe"});
  Report report = makeReport(folder, "probe");
  report.require("force, finite", "always", "not always", false);
  report.write();
  EXPECT_TRUE(
      has(makePage(folder / ""), "| force, finite | always | - | **not always** | - | |\n"));
}

TEST(ReportPage, ShowsMeansOfStagesWithoutGoals) {
  const TempFolder folder;
  const PageTopics registered({"probe"});
  Report report = makeReport(folder, "probe");
  for (const double error : {1.0, 4.0}) {
    const std::string scene = text("%g", error);
    report.add(Row{scene, "bytes", "plan", error, "bytes", 0, true});
    report.add(Row{scene, "velocity", "rgbd", error, "px", 0, true});
    report.add(Row{scene, "velocity", "thesis", 10 * error, "px", 0, false, true});
  }
  report.add(Row{"0", "bytes", "plan", 0.0, "bytes", 0, true});
  report.write();
  const std::string page = makePage(folder / "");
  EXPECT_TRUE(has(page,
                  "| velocity | - | - | 2 | 20 | px |\n"
                  "| bytes (rms) | - | - | 2.38 | - | bytes |\n"));
  EXPECT_TRUE(has(page, "| [probe](#probe) | - | - | about |"));
}

TEST(ReportPage, LeavesOutAnAbsentTopicAndShowsPicturesThatAreThere) {
  const TempFolder folder;
  const PageTopics registered({"absent", "probe"});
  folder.write(
      "probe.csv",
      "scene,stage,variant,error,unit,time_us,is_default,is_thesis\na,goal,got,2,%,0,1,0\n");
  folder.write("drawn.png", "");
  topics()["probe"].pictures = {{"drawn.png", "a curve"}, {"other.png", "not there"}};
  const std::string page = makePage(folder / "");
  EXPECT_FALSE(has(page, "absent"));
  EXPECT_TRUE(has(page, "\n![a curve](drawn.png)\n"));
  EXPECT_FALSE(has(page, "other.png"));
  EXPECT_TRUE(has(page, "| a | - | - | 2 | - | % |\n\nAn older file. All rows: "));
}

TEST(ReportPage, IsAtMost200LinesLong) {
  const TempFolder folder;
  const PageTopics registered({"a", "b", "c", "d", "e", "f", "g", "h"});
  for (auto& [name, topic] : topics()) {
    Report report = makeReport(folder, name);
    for (int i = 0; i < 100; ++i) report.add(Goal{text("goal %d", i), "%", 10, 1, 0.2 * i});
    report.write();
    folder.write(name + ".png", "");
    for (int i = 0; i < 90; ++i) topic.method += " word";
  }
  const std::string page = makePage(folder / "");
  EXPECT_LE(countLines(page), 200);
  EXPECT_TRUE(has(page, "41 more goals missed, 51 more goals met"));
}

TEST(ReportPage, TheCommittedPageIsAtMost200LinesLong) {
  const std::string page = readPage(HAPTICAST_TESTS "/evaluate/report/report.md");
  EXPECT_TRUE(has(page, "## accuracy"));
  EXPECT_LE(countLines(page), 200);
}

}  // namespace hapticast::evaluate
