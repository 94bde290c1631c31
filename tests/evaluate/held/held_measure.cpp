// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held_measure.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/evaluate/vision/vision_sheet.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr double kGoodStart = 0.8;  // IoU
constexpr double kBadStart = 0.5;
constexpr double kBesideRim_px = 4.0;  // nobody corrects the very rim
constexpr int kSaid_px = 40;           // about a correction
constexpr double kFromEdge_px = 3.0;   // nobody clicks on the very edge

const char* nameOf(DepthSense sense) {
  switch (sense) {
    case DepthSense::kExact:
      return "exact";
    case DepthSense::kStructured:
      return "structured";
    case DepthSense::kFlight:
      return "flight";
    case DepthSense::kRoom8:
      return "room8";
    case DepthSense::kEstimate8:
      return "estimate8";
    case DepthSense::kEstimate16:
      return "estimate16";
  }
  return "";
}

cv::Mat depthPicture(const server::RgbdFrame& frame, const server::SourceInfo& info) {
  cv::Mat levels;
  if (info.depth_kind == server::DepthKind::kHeight) {
    frame.depth.convertTo(levels, CV_8U);
  } else {
    cv::Mat(255.0 - (frame.depth - 300.0) * (255.0 / 1000.0)).convertTo(levels, CV_8U);
    levels.setTo(0, frame.depth == 0);
  }
  cv::cvtColor(levels, levels, cv::COLOR_GRAY2BGR);
  return levels;
}

void drawSheet(const Recording& recording, const Run& run, const std::filesystem::path& sheets) {
  ContactSheet sheet(1);
  const std::size_t every = std::max<std::size_t>(1, recording.frames.size() / 8);
  for (std::size_t i = 0; i < run.masks.size(); i += every) {
    const server::RgbdFrame& frame = recording.frames[i];
    const cv::Mat truth = recording.truth[i].mask();
    sheet.show(frame.color, run.masks[i], truth, i);
    sheet.show(depthPicture(frame, recording.info), run.masks[i], truth, i);
  }
  sheet.write(sheets / ("vision_held_" + recording.name + ".png"));
}

Starts clickAround(const Recording& recording, double clicks) {
  const cv::Mat truth = recording.truth[0].mask();
  cv::Mat distance;
  cv::distanceTransform(truth, distance, cv::DIST_L2, 5);
  const int step = std::max(2, static_cast<int>(std::sqrt(cv::countNonZero(truth) / clicks)));
  Starts out;
  for (int v = step / 2; v < truth.rows; v += step) {
    for (int u = step / 2; u < truth.cols; u += step) {
      if (double(distance.at<float>(v, u)) < kFromEdge_px) continue;
      ++out.clicks;
      const auto mask = startOf(recording, {{{u + 0.5, v + 0.5}}, {}});
      if (!mask) ++out.refused;
      const double iou = mask ? overlapOf(*mask, truth) : 0.0;
      if (iou > kGoodStart) ++out.good;
      if (iou < kBadStart) ++out.bad;
    }
  }
  return out;
}

// Where the author says "not this": in what is wrong in the first frame, in a hand rather than
// elsewhere, else in the hand; not where it was said already.
std::optional<Vec2> correctionAfter(const Recording& recording, const Clicks& clicks) {
  const Truth& truth = recording.truth[0];
  cv::Mat fresh = cv::Mat(truth.id.size(), CV_8UC1, cv::Scalar(255));
  for (const Vec2& not_px : clicks.off)
    cv::circle(fresh, cv::Point(cvRound(not_px.x()), cvRound(not_px.y())), kSaid_px, cv::Scalar(0),
               -1);
  const cv::Mat hand =
      fresh & ((truth.id == static_cast<int>(kHand)) | (truth.id == static_cast<int>(kOtherHand)));
  if (const auto mask = startOf(recording, clicks)) {
    cv::Mat distance;
    cv::distanceTransform(truth.mask() == 0, distance, cv::DIST_L2, 5);
    const cv::Mat wrong = *mask & (distance > kBesideRim_px) & fresh;
    if (auto at = innermost(wrong & hand)) return at;
    if (auto at = innermost(wrong)) return at;
  }
  return innermost(hand);
}

}  // namespace

Result measure(const Scene& scene, const std::filesystem::path& sheets, double clicks_to_try) {
  const Recording recording = record(scene, {640, 480});
  Result out;
  out.name = scene.name;
  out.sensor = nameOf(scene.sensing.kind);
  out.held_at_start = scene.held_at_start;
  Clicks clicks{{*innermost(recording.truth[0].mask())}, {}};
  const Run run = watch(recording, clicks);
  out.one_click = scoresOf(recording, run);
  out.refused = run.refused;
  if (!sheets.empty()) drawSheet(recording, run, sheets);
  out.starts = clickAround(recording, clicks_to_try);
  if (!scene.held_at_start) return out;
  for (Scores* scores : {&out.one_not, &out.two_nots}) {
    const auto correction = correctionAfter(recording, clicks);
    if (correction) clicks.off.push_back(*correction);
    *scores = scoresOf(recording, watch(recording, clicks));
  }
  out.corrected = true;
  return out;
}

Scores timesOf(const Scene& scene, const cv::Size& size, std::size_t frames) {
  const Recording recording = record(scene, size, frames);
  return scoresOf(recording, watch(recording, {{*innermost(recording.truth[0].mask())}, {}}));
}

}  // namespace hapticast::evaluate::held
