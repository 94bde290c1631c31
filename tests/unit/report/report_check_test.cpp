// SPDX-License-Identifier: MIT
// The checks of --check: a figure that got worse or went missing fails, another does not; baselines
// that cannot be read are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/evaluate/report_check.hpp"
#include "tests/evaluate/report_csv.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::evaluate {

namespace {

const std::string kColumns = "scene,stage,variant,error,unit,time_us,is_default,is_thesis\n";

Row makeFigure(double error, const std::string& unit = "%", bool is_default = true) {
  return {"sphere", "force, still surface", "proxy", error, unit, 0.16, is_default, false};
}

std::vector<std::string> findFailures(const std::vector<Row>& got,
                                      const std::vector<Row>& baseline) {
  return compareRows({"accuracy"}, got, baseline).failures;
}

::testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "'" << part << "' is not in '" << text << "'";
}

::testing::AssertionResult isEmpty(const std::vector<std::string>& lines) {
  if (lines.empty()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << lines.size() << " lines, first '" << lines[0] << "'";
}

::testing::AssertionResult isOneLine(const std::vector<std::string>& lines,
                                     const std::string& part) {
  if (lines.size() == 1) return contains(lines[0], part);
  return ::testing::AssertionFailure() << lines.size() << " lines instead of one";
}

/// Returns what the exception of `run` says; empty without one.
template <class Run>
std::string catchRefusal(Run run) {
  try {
    run();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

std::string readBadLine(const std::string& line) {
  const TempFolder folder;
  const std::string file = folder.write("accuracy.csv", kColumns + line);
  return catchRefusal([&] { (void)readRows(file); });
}

Options makeOptions(const TempFolder& folder, const std::string& baseline) {
  Options options;
  options.out = folder / "out";
  options.check = true;
  options.baseline = folder / baseline;
  return options;
}

}  // namespace

TEST(ReportCheck, AFigureThatGotMuchWorseFails) {
  EXPECT_TRUE(isOneLine(findFailures({makeFigure(14.0)}, {makeFigure(10.0)}),
                        "accuracy; sphere; force, still surface; proxy: got 14 %, baseline 10, "
                        "limit 13.02 %"));
}

TEST(ReportCheck, AFigureThatGotLittleWorseOrBetterPasses) {
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(12.0)}, {makeFigure(10.0)})));
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(1.0)}, {makeFigure(10.0)})));
}

TEST(ReportCheck, TheFloorOfTheUnitLetsRoundingPass) {
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(1e-13)}, {makeFigure(0.0)})));
  EXPECT_TRUE(isOneLine(findFailures({makeFigure(0.06)}, {makeFigure(0.0)}), "got 0.06 %"));
}

TEST(ReportCheck, AUnitWithoutFloorAllowsTheMarginOnly) {
  EXPECT_TRUE(isOneLine(findFailures({makeFigure(1.0, "frames")}, {makeFigure(0.0, "frames")}),
                        "got 1 frames, baseline 0, limit 0 frames"));
}

TEST(ReportCheck, OfSomeUnitsMoreIsBetter) {
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(900.0, "N/m")}, {makeFigure(400.0, "N/m")})));
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(334.0, "N/m")}, {makeFigure(400.0, "N/m")})));
  EXPECT_TRUE(isOneLine(findFailures({makeFigure(286.0, "N/m")}, {makeFigure(400.0, "N/m")}),
                        "limit 307.7 N/m"));
}

TEST(ReportCheck, TheMarginOfANegativeFigureIsOfItsSize) {
  EXPECT_DOUBLE_EQ(findLimit(makeFigure(-100.0, "mJ")), -69.0);
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(-80.0, "mJ")}, {makeFigure(-100.0, "mJ")})));
  EXPECT_TRUE(
      isOneLine(findFailures({makeFigure(-60.0, "mJ")}, {makeFigure(-100.0, "mJ")}), "got -60 mJ"));
}

TEST(ReportCheck, FailsForValuesThatAreNoNumbers) {
  EXPECT_TRUE(isOneLine(findFailures({makeFigure(std::nan(""))}, {makeFigure(10.0)}), "nan"));
  EXPECT_TRUE(isWorse(std::numeric_limits<double>::infinity(), makeFigure(400.0)));
  EXPECT_TRUE(isWorse(std::nan(""), makeFigure(400.0, "N/m")));
}

TEST(ReportCheck, RunTimesAreNeverCompared) {
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(900.0, "us")}, {makeFigure(10.0, "us")})));
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(1.0, "1/s")}, {makeFigure(90.0, "1/s")})));
  Row before = makeFigure(2.0, "ms");
  before.stage = "held: run time, 95 %";
  Row now = before;
  now.error = 50.0;
  EXPECT_TRUE(isEmpty(findFailures({now}, {before})));
  now = before = makeFigure(1.0);
  now.time_us = 1e6;
  EXPECT_TRUE(isEmpty(findFailures({now}, {before})));
}

TEST(ReportCheck, VariantsThatAreNoDefaultAreNotCompared) {
  EXPECT_TRUE(isEmpty(findFailures({makeFigure(90.0, "%", false)}, {makeFigure(1.0, "%", false)})));
}

TEST(ReportCheck, AFigureThatWentMissingFails) {
  Row other = makeFigure(2.0);
  other.scene = "ellipsoid";
  EXPECT_TRUE(isOneLine(findFailures({makeFigure(1.0)}, {makeFigure(1.0), other}),
                        "ellipsoid; force, still surface; proxy: got nothing"));
  EXPECT_TRUE(
      isOneLine(findFailures({makeFigure(1.0, "%", false)}, {makeFigure(1.0)}), "got nothing"));
}

TEST(ReportCheck, APartIsNotAskedForTheRest) {
  const Scope part{"accuracy", false, {}};
  EXPECT_TRUE(isEmpty(compareRows(part, {}, {makeFigure(1.0)}).failures));
  EXPECT_TRUE(isOneLine(compareRows(part, {makeFigure(1.4)}, {makeFigure(1.0)}).failures, "1.4"));
}

TEST(ReportCheck, AClipThatIsAbsentIsANote) {
  const Comparison found = compareRows({"motion", true, {"sphere"}}, {}, {makeFigure(1.0)});
  EXPECT_TRUE(isEmpty(found.failures));
  EXPECT_TRUE(
      isOneLine(found.remarks, "motion; sphere: 1 figures not compared, its clip is absent"));
}

TEST(ReportCheck, ANewFigureIsANote) {
  const Comparison found = compareRows({"accuracy"}, {makeFigure(1.0)}, {});
  EXPECT_TRUE(isEmpty(found.failures));
  EXPECT_TRUE(isOneLine(found.remarks, "got 1 %, no baseline"));
}

TEST(ReportCheck, AnotherUnitFails) {
  EXPECT_TRUE(isOneLine(findFailures({makeFigure(1.0, "mN")}, {makeFigure(1.0, "N")}),
                        "got 1 mN, baseline 1, limit 1.301 N"));
}

TEST(ReportCheckCsv, ReadsAWrittenReport) {
  const TempFolder folder;
  Row other{"box", "roughness", "normal", 1e-13, "mN per tick", 0.0, false, true};
  writeRows(folder / "accuracy.csv", {makeFigure(-0.7148), other});
  const std::vector<Row> rows = readRows(folder / "accuracy.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].scene, "sphere");
  EXPECT_EQ(rows[0].stage, "force, still surface");
  EXPECT_EQ(rows[0].variant, "proxy");
  EXPECT_EQ(rows[0].error, -0.7148);
  EXPECT_EQ(rows[0].unit, "%");
  EXPECT_EQ(rows[0].time_us, 0.16);
  EXPECT_TRUE(rows[0].is_default && !rows[0].is_thesis);
  EXPECT_EQ(rows[1].error, 1e-13);
  EXPECT_TRUE(!rows[1].is_default && rows[1].is_thesis);
}

TEST(ReportCheckCsv, ATableKeepsCommasAndQuotes) {
  const TempFolder folder;
  const Table lines{{"lie", "verdict, N"}, {"a \"false\" one", ""}, {"\"", ",\",\""}};
  writeTable(folder / "probe_lies.csv", lines);
  EXPECT_EQ(readTable(folder / "probe_lies.csv"), lines);
  EXPECT_EQ(readTable(folder / "absent.csv"), Table());
}

TEST(ReportCheckCsv, RefusesALineThatIsNoRow) {
  EXPECT_TRUE(contains(readBadLine("a,b,c,1,%,0,1\n"), "accuracy.csv:2: 7 fields instead of 8"));
  EXPECT_TRUE(contains(readBadLine("a,b,c,1,%,0,1,0,0\n"), "9 fields"));
  EXPECT_TRUE(contains(readBadLine("a,\"b,c,1,%,0,1,0\n"), "2 fields"));
  EXPECT_TRUE(contains(readBadLine("\n"), "1 fields"));
  EXPECT_TRUE(contains(readBadLine("a,b,c,1.2x,%,0,1,0\n"), "'1.2x' is no number"));
  EXPECT_TRUE(contains(readBadLine("a,b,c,,%,0,1,0\n"), "'' is no number"));
  EXPECT_TRUE(contains(readBadLine("a,b,c,1,%,0,yes,0\n"), "'yes' is neither 0 nor 1"));
  EXPECT_TRUE(contains(readBadLine("a,b,c,1,%,0,1,0\na,b,c,2,%,0,1,0\n"), ":3: the same figure"));
}

TEST(ReportCheckCsv, RefusesOtherColumns) {
  const TempFolder folder;
  const std::string file = folder.write("codec.csv", "scene,error\n");
  EXPECT_TRUE(
      contains(catchRefusal([&] { (void)readRows(file); }), "codec.csv:1: the columns are not"));
  EXPECT_TRUE(contains(catchRefusal([&] { (void)readRows(folder / "none.csv"); }), "cannot read"));
}

TEST(ReportCheckOfAReport, ComparesRowsAndGoalsWithTheBaseline) {
  const TempFolder folder;
  folder.write("baseline/probe.csv",
               kColumns + "a,b,c,1,%,0,1,0\nworst of it,goal,got,2,%,0,1,0\n");
  for (const bool worse : {false, true}) {
    Report report("probe", makeOptions(folder, "baseline"));
    report.add(Row{"a", "b", "c", 1.2, "%", 0.0, true, false});
    report.add(Goal{"worst of it", "%", 5.0, 1.0, worse ? 2.8 : 2.4});
    const std::string said = catchRefusal([&] { report.write(); });
    EXPECT_EQ(said, worse ? "probe: --check failed\n  probe; worst of it; goal; got: got 2.8 %, "
                            "baseline 2, limit 2.62 %"
                          : "");
  }
}

TEST(ReportCheckOfAReport, KeepsItsRequirements) {
  const TempFolder folder;
  folder.write("baseline/probe.csv", kColumns + "worst of it,goal,got,1.9,%,0,1,0\n");
  Report report("probe", makeOptions(folder, "baseline"));
  report.add(Goal{"worst of it", "%", 1.95, 1.0, 2.0});
  report.require("all are finite", "always", "not always", false);
  report.require("all are small", "always", "always", true);
  EXPECT_EQ(catchRefusal([&] { report.write(); }),
            "probe: --check failed\n  probe; worst of it: got 2 %, required 1.95\n  probe; all "
            "are finite: got 1 missed, required 0");
}

TEST(ReportCheckOfAReport, ARequirementThatTheBaselineMissesMayGetLittleWorse) {
  const TempFolder folder;
  folder.write("baseline/probe.csv", kColumns + "worst of it,goal,got,2,%,0,1,0\n");
  for (const bool worse : {false, true}) {
    Report report("probe", makeOptions(folder, "baseline"));
    report.add(Goal{"worst of it", "%", 1.5, 1.0, worse ? 2.8 : 2.4});
    EXPECT_EQ(catchRefusal([&] { report.write(); }).empty(), !worse);
  }
}

TEST(ReportCheckOfAReport, ReportsWhichBaselineIsMissingBeforeItMeasures) {
  const TempFolder folder;
  EXPECT_EQ(catchRefusal([&] { Report("probe", makeOptions(folder, "none")); }),
            "--check: there is no baseline " + (folder / "none/probe.csv").string() +
                " (--baseline names its folder)");
}

TEST(ReportCheckOfAReport, AWrittenReportIsItsOwnBaseline) {
  const TempFolder folder;
  Options options;
  options.out = folder / "out";
  for (const bool check : {false, true}) {
    options.check = check;
    options.baseline = options.out;
    Report report("probe", options);
    report.add(makeFigure(0.7148));
    report.add(Goal{"worst, of all", "", 5.0, 1.0, 2.0});
    EXPECT_EQ(catchRefusal([&] { report.write(); }), "");
    EXPECT_EQ(readRows(options.out / "probe.csv").size(), 4U);  // got, required and aim
  }
}

}  // namespace hapticast::evaluate
