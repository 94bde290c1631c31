// SPDX-License-Identifier: MIT
#include "tests/evaluate/report_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>

#include "tests/evaluate/report_plot.hpp"

namespace hapticast::evaluate {

namespace {

struct UnitRule {
  std::string_view unit;
  double floor;  // is added to the margin, so that figures near 0 do not fail by rounding
  bool more_is_better = false;
};

// Differences that no user notices. A unit that is not here has no floor.
constexpr UnitRule kRules[] = {
    {"%", 0.02},                            // of a force of 0.5 N: 0.1 mN
    {"points", 0.02},                       // the same, of percent
    {"N", 1e-3},                            // the threshold of fingers is some 10 mN
    {"N rms", 1e-3},                        // the same
    {"mN", 0.1},                            // a hundredth of that threshold
    {"mN per tick", 0.01},                  // the same after 10 ticks
    {"mm", 1e-3},                           // 1/55 of an encoder count
    {"mm rms inside", 0.01},                // a fifth of an encoder count
    {"mm rms in the 5 px rim", 0.02},       // the rim is where a mask ends: coarser
    {"mm/s", 1.0},                          // 1 um in a tick
    {"mm/s rms", 0.1},                      // a tenth of that
    {"mm/s2", 1.0},                         // 0.05 mN at a cursor of 45 g
    {"px", 5e-3},                           // 1/200 of a pixel
    {"px/frame", 2e-3},                     // a pixel in 20 s
    {"level/frame", 2e-3},                  // a level of depth in 20 s
    {"counts", 0.05},                       // a twentieth of an encoder count
    {"mJ", 1.0},                            // a ball of 1 g that falls from 10 cm
    {"1 - IoU", 1e-3},                      // a twentieth of a pixel around a ball of 200 px
    {"share of the area", 1e-3},            // the same
    {"share of the area per frame", 1e-3},  // the same
    {"share", 0.01},                        // a frame, or a click, of a hundred
    {"share of clicks not > .8", 0.01},     // the same
    {"share of 30 mm", 0.01},               // the same
    {"of the rms", 0.01},                   // a hundredth of the motion
    {"of the mean square", 0.01},           // the same
    {"ticks", 1.0},                         // a tick more or less of rounding
    {"ms", 0.1},                            // a tenth of a tick
    {"bytes", 16.0},                        // less than the head of a datagram
    {"bytes/frame", 16.0},                  // the same
    {"N/m", 0.0, true},                     // stiffness at which an integrator breaks
    {"m_cursor/m", 0.0, true},              // the heaviest cursor that is stable
};

UnitRule findRule(const std::string& unit) {
  for (const UnitRule& rule : kRules) {
    if (rule.unit == unit) return rule;
  }
  return {unit, 0.0};
}

bool isRunTime(const Row& row) {
  return row.unit == "us" || row.unit == "1/s" || row.stage.find("run time") != std::string::npos;
}

using Key = std::tuple<std::string, std::string, std::string>;

Key makeKey(const Row& row) { return {row.scene, row.stage, row.variant}; }

std::map<Key, const Row*> selectCompared(const std::vector<Row>& rows) {
  std::map<Key, const Row*> selected;
  for (const Row& row : rows) {
    if (isCompared(row)) selected[makeKey(row)] = &row;
  }
  return selected;
}

std::string describeFigure(const Scope& scope, const Row& row) {
  return scope.topic + "; " + row.scene + "; " + row.stage + "; " + row.variant + ": ";
}

std::string describeLimit(const Row& baseline) {
  return ", baseline " + number(baseline.error) + ", limit " + number(findLimit(baseline)) + ' ' +
         baseline.unit;
}

}  // namespace

bool isCompared(const Row& row) { return row.is_default && !isRunTime(row); }

double findLimit(const Row& baseline) {
  const UnitRule rule = findRule(baseline.unit);
  if (rule.more_is_better) return baseline.error / kMargin - rule.floor;
  return baseline.error + (kMargin - 1.0) * std::abs(baseline.error) + rule.floor;
}

bool isWorse(double got, const Row& baseline) {
  const double limit = findLimit(baseline);
  return findRule(baseline.unit).more_is_better ? !(got >= limit) : !(got <= limit);
}

Row makeRow(const Goal& goal) {
  return {goal.what, "goal", "got", goal.got, goal.unit, 0.0, true, false};
}

std::vector<Row> makeRows(const Goal& goal) {
  std::vector<Row> rows{makeRow(goal)};
  const auto add = [&](const char* variant, double value) {
    rows.push_back({goal.what, "goal", variant, value, goal.unit});
  };
  add("required", goal.required);
  add("aim", goal.aim);
  if (goal.thesis < 0) return rows;
  add("thesis", goal.thesis);
  rows.back().is_thesis = true;
  return rows;
}

bool wasMissed(const Goal& goal, const std::vector<Row>& baseline) {
  const Key key = makeKey(makeRow(goal));
  return std::any_of(baseline.begin(), baseline.end(), [&](const Row& row) {
    return makeKey(row) == key && row.error > goal.required;
  });
}

Comparison compareRows(const Scope& scope, const std::vector<Row>& got,
                       const std::vector<Row>& baseline) {
  Comparison out;
  const std::map<Key, const Row*> before = selectCompared(baseline);
  const std::map<Key, const Row*> now = selectCompared(got);
  std::map<std::string, int> skipped;
  for (const auto& [key, row] : before) {
    if (now.contains(key) || !scope.whole) continue;
    if (scope.absent_scenes.contains(row->scene)) {
      ++skipped[row->scene];
    } else {
      out.failures.push_back(describeFigure(scope, *row) + "got nothing" + describeLimit(*row));
    }
  }
  for (const auto& [scene, count] : skipped) {
    out.remarks.push_back(scope.topic + "; " + scene + ": " + std::to_string(count) +
                          " figures not compared, its clip is absent");
  }
  for (const Row& row : got) {
    if (!isCompared(row)) continue;
    const auto found = before.find(makeKey(row));
    if (found == before.end()) {
      out.remarks.push_back(describeFigure(scope, row) + "got " + number(row.error) + ' ' +
                            row.unit + ", no baseline");
    } else if (row.unit != found->second->unit || isWorse(row.error, *found->second)) {
      out.failures.push_back(describeFigure(scope, row) + "got " + number(row.error) + ' ' +
                             row.unit + describeLimit(*found->second));
    }
  }
  return out;
}

}  // namespace hapticast::evaluate
