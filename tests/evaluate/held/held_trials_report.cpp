// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held_trials_report.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::evaluate {

namespace {

using held::Result;

std::string shownOr(double value) { return value < -1e3 ? "" : text("%.3f", value); }
std::string where(const Result& r) { return r.name + "/" + r.sensor; }

struct TrialReport {
  const std::string& apart;
  Report& report;

  void row(const Result& r, const char* stage, double error, const char* unit) const {
    report.add({where(r), stage, "band", error, unit, 0.0, true, false});
  }
  void goal(const char* what, const char* unit, double required, double aim, double got) const {
    report.add(Goal{what + apart, unit, required, aim, got});
  }
};

void reportLaterStarts(const std::vector<Result>& results, const TrialReport& trial_report) {
  Table lines{{"scene", "first frame", "a third", "two thirds", "clicks", "refused"}};
  held::Starts sum;
  for (const Result& r : results) {
    held::Starts own;
    std::vector<std::string> line{r.name};
    for (const held::Starts& starts : r.trials->starts) {
      line.push_back(starts.clicks > 0 ? text("%.2f", starts.share(starts.good)) : "");
      own.add(starts);
    }
    line.push_back(std::to_string(own.clicks));
    line.push_back(std::to_string(own.refused));
    lines.push_back(line);
    sum.add(own);
    if (own.clicks > 0)
      trial_report.row(r, "held: starts, three frames", 1.0 - own.share(own.good),
                       "share of clicks not > .8");
  }
  trial_report.report.addTable("later_clicks", lines);
  if (sum.clicks == 0) return;
  trial_report.goal("held, clicks at three frames: bad starts", "share", 0.15, 0.05,
                    1.0 - sum.share(sum.good));
  trial_report.goal("held, clicks at three frames: refused", "", 0.0, 0.0, double(sum.refused));
}

void reportAutomatic(const std::vector<Result>& results, const TrialReport& trial_report) {
  Table lines{{"scene", "first frame", "a third", "two thirds"}};
  for (const Result& r : results) {
    std::vector<std::string> line{r.name};
    double own = 0.0;
    double tried = 0.0;
    for (const double iou : r.trials->chosen_iou) {
      line.push_back(iou >= 0 ? text("%.2f", iou) : "");
      if (iou < 0) continue;
      own += iou;
      tried += 1.0;
    }
    lines.push_back(line);
    if (tried > 0) trial_report.row(r, "held: start without a click", 1.0 - own / tried, "1 - IoU");
  }
  trial_report.report.addTable("automatic", lines);
}

void reportRandomCorrections(const std::vector<Result>& results, const TrialReport& trial_report) {
  Table lines{{"scene", "IoU mean", "IoU worst", "one click", "one click worst", "new", "emptied"}};
  double mean = 0.0;
  double worst = 1.0;
  int emptied = 0;
  for (const Result& r : results) {
    const held::Corrected& c = r.trials->corrected;
    lines.push_back({r.name, text("%.3f", c.scores.mean_iou), text("%.3f", c.scores.worst_iou),
                     text("%.3f", r.one_click.mean_iou), text("%.3f", r.one_click.worst_iou),
                     text("%d of 2", 2 - c.uninformative), std::to_string(c.emptied)});
    trial_report.row(r, "held: mask, corrected at random times", 1.0 - c.scores.mean_iou,
                     "1 - IoU");
    trial_report.row(r, "held: worst mask, corrected at random times", 1.0 - c.scores.worst_iou,
                     "1 - IoU");
    trial_report.row(r, "held: emptied by a correction", double(c.emptied), "runs");
    mean += c.scores.mean_iou / double(results.size());
    worst = std::min(worst, c.scores.worst_iou);
    emptied += c.emptied;
  }
  trial_report.report.addTable("random_corrections", lines);
  trial_report.goal("held, corrected at random times: 1 - IoU, mean", "", 0.05, 0.02, 1.0 - mean);
  trial_report.goal("held, corrected at random times: 1 - IoU, worst", "", 0.12, 0.06, 1.0 - worst);
  trial_report.goal("held, corrected at random times: runs emptied", "", 0.0, 0.0, double(emptied));
}

void reportGrabCut(const std::vector<Result>& results, const TrialReport& trial_report) {
  double worst = -1.0;
  for (const Result& r : results) {
    const held::CutScores& cut = r.trials->cut;
    if (cut.carried < 0) continue;
    trial_report.report.add(
        {where(r), "held: mask, every fifth frame", "GrabCut", 1.0 - cut.grab_cut, "1 - IoU"});
    trial_report.row(r, "held: mask, every fifth frame", 1.0 - cut.carried, "1 - IoU");
    worst = std::max(worst, cut.grab_cut - cut.carried);
  }
  trial_report.goal("held: IoU of GrabCut less that of the carried mask, worst scene", "", 0.0,
                    -0.1, worst);
}

void reportTurned(const std::vector<Result>& results, const TrialReport& trial_report) {
  double least = 1.0;
  for (const Result& r : results) {
    const held::TurnedScores& turned = r.trials->turned;
    trial_report.row(r, "held: start, turned picture", 1.0 - turned.on_object, "1 - IoU");
    least = std::min(least, turned.on_object);
    if (turned.on_hand < 0) continue;
    trial_report.row(r, "held: start on a hand, turned picture", 1.0 - turned.on_hand, "1 - IoU");
    least = std::min(least, turned.on_hand);
  }
  trial_report.goal("held, turned picture: 1 - overlap of the starts, worst", "", 0.10, 0.03,
                    1.0 - least);
}

}  // namespace

void reportTrials(const std::vector<Result>& results, const std::string& apart, Report& report) {
  if (results.empty() || !results.front().trials) return;
  const TrialReport trial_report{apart, report};
  reportLaterStarts(results, trial_report);
  reportAutomatic(results, trial_report);
  reportRandomCorrections(results, trial_report);
  reportGrabCut(results, trial_report);
  reportTurned(results, trial_report);
}

void reportGains(const std::vector<Result>& results, const std::string& apart, Report& report) {
  const TrialReport trial_report{apart, report};
  Table lines{{"scene", "gain in x", "in y", "wrong sign", "without the object"}};
  double off = 0.0;
  double wrong_sign = 0.0;
  std::size_t blank = 0;
  for (const Result& r : results) {
    const held::Scores& s = r.one_click;
    lines.push_back({r.name + (s.grid_share >= 0 ? " (bends)" : ""), shownOr(s.velocity_gain.x()),
                     shownOr(s.velocity_gain.y()), text("%.3f", s.wrong_sign),
                     text("%zu frames", s.blank)});
    trial_report.row(r, "held: without object", double(s.blank), "frames");
    blank += s.blank;
    // What bends has many velocities.
    if (!r.held_at_start || s.grid_share >= 0) continue;
    trial_report.row(r, "held: velocity, wrong sign", s.wrong_sign, "share");
    wrong_sign = std::max(wrong_sign, s.wrong_sign);
    for (const double gain : {s.velocity_gain.x(), s.velocity_gain.y()}) {
      if (gain > -1e3) off = std::max(off, std::abs(gain - 1.0));
    }
  }
  report.addTable("gains", lines);
  trial_report.goal("held: frames without the object", "", 0.0, 0.0, double(blank));
  trial_report.goal("held: velocity gain off 1, worst rigid held scene", "share", 0.20, 0.05, off);
  trial_report.goal("held: velocity of the wrong sign, worst rigid held scene", "share", 0.0, 0.0,
                    wrong_sign);
}

}  // namespace hapticast::evaluate
