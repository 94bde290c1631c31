// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "tests/evaluate/held/held_trials.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr double kReach_mm = 150.0;  // from the click, in the picture and in depth
constexpr int kLikely = 3;           // probably the object: within this part of the reach
constexpr int kClick_px = 4;         // radius of what is certainly the object
constexpr int kFrame_px = 8;         // certain background around the window
constexpr int kRounds = 5;
constexpr std::size_t kEvery = 5;  // frames
constexpr double kMeasurable = 1.0 / 3.0;

// The sensor's depth, in mm; 0: none.
cv::Mat depthInMillimetres(const Recording& recording, std::size_t frame) {
  const cv::Mat& depth = recording.frames[frame].depth;
  const Sensing& sensing = recording.sensing;
  if (!sensing.inHeights()) return depth;
  if (sensing.kind == DepthSense::kRoom8)
    return sensing.far_mm - depth * ((sensing.far_mm - sensing.near_mm) / 255.0);
  const double farthest = 0.5 / sensing.far_mm;
  const double nearest = 1.0 / sensing.near_mm;
  return 1.0 / cv::Mat(depth * ((nearest - farthest) / 255.0) + farthest);
}

// GrabCut in a window about the click; the piece at the click, 0 / 255.
cv::Mat grabCutAt(const Recording& recording, std::size_t frame, const Vec2& click) {
  const cv::Mat& color = recording.frames[frame].color;
  const cv::Point at(static_cast<int>(click.x()), static_cast<int>(click.y()));
  const double z_mm = double(recording.truth[frame].depth.at<float>(at));
  const int reach_px = static_cast<int>(kReach_mm * recording.camera.fx_px / z_mm);
  const cv::Rect picture({}, color.size());
  const cv::Rect around = cv::Rect(at.x, at.y, 1, 1);
  const cv::Rect inner = server::growRect(around, reach_px, color.size());
  const cv::Rect window = server::growRect(around, reach_px + kFrame_px, color.size());
  cv::Mat marks(color.size(), CV_8UC1, cv::Scalar(cv::GC_BGD));
  // To begin with "probably the object" everywhere, or nowhere, gives GrabCut far worse masks.
  marks(inner).setTo(cv::GC_PR_BGD);
  marks(server::growRect(around, reach_px / kLikely, color.size())).setTo(cv::GC_PR_FGD);
  const cv::Mat depth = depthInMillimetres(recording, frame);
  const cv::Mat beyond = (cv::abs(depth - z_mm) > kReach_mm) & (depth > 0);
  marks.setTo(cv::GC_BGD, beyond);
  cv::circle(marks, at, kClick_px, cv::GC_FGD, cv::FILLED);
  cv::Mat inside = marks(window).clone();
  cv::Mat out = cv::Mat::zeros(color.size(), CV_8UC1);
  if (cv::countNonZero(inside == cv::GC_BGD) == 0) return out;
  cv::Mat background;
  cv::Mat foreground;
  cv::setRNGSeed(1);  // its colours' clusters begin at random
  cv::grabCut(color(window), inside, {}, background, foreground, kRounds, cv::GC_INIT_WITH_MASK);
  cv::Mat((inside == cv::GC_FGD) | (inside == cv::GC_PR_FGD)).copyTo(out(window));
  return server::findPiece(out, at);
}

}  // namespace

CutScores compareWithGrabCut(const Recording& recording, const Run& run) {
  CutScores sum{0.0, 0.0};
  double frames = 0.0;
  for (std::size_t i = 0; i < recording.frames.size(); i += kEvery) {
    if (recording.truth[i].visibleShare() < kMeasurable) continue;
    const cv::Mat truth = recording.truth[i].mask();
    const cv::Mat cut = grabCutAt(recording, i, *innermost(truth));
    sum.grab_cut += server::computeOverlap(cut, truth);
    if (!run.masks[i].empty()) sum.carried += server::computeOverlap(run.masks[i], truth);
    frames += 1.0;
  }
  if (frames == 0.0) return {};
  return {sum.grab_cut / frames, sum.carried / frames};
}

}  // namespace hapticast::evaluate::held
