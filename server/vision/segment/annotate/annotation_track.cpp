// SPDX-License-Identifier: MIT
#include "server/vision/segment/annotate/annotation_track.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/appearance/graph_cut.hpp"

namespace hapticast::server {

namespace {

// Chosen: smaller than a hand, larger than a finger with its shadow.
constexpr double kJoined_mm = 60;
constexpr double kLeastPatch_mm = 25;  // chosen: excludes the colours of rims and shadows
// Chosen, log density: two standard deviations of camera noise.
constexpr float kLikeThePoint = -7.0F;

cv::Point toPixel(const AuthorPoint& point) {
  return {static_cast<int>(point.at_px.x()), static_cast<int>(point.at_px.y())};
}

// Returns the latest time of annotations that belong to the frame or an earlier one.
double endTime(double clip_time_s, const FramePair& frames) {
  return clip_time_s < 0.0 ? -1.0 : clip_time_s + 0.5 * frames.frame_s;
}

std::vector<AuthorPoint> selectDue(const std::vector<AuthorPoint>& points,
                                   const FramePair& frames) {
  const double begin_s = endTime(frames.last_clip_time_s, frames);
  const double end_s = endTime(frames.clip_time_s, frames);
  std::vector<AuthorPoint> due;
  std::copy_if(points.begin(), points.end(), std::back_inserter(due),
               [&](const auto& point) { return point.time_s > begin_s && point.time_s <= end_s; });
  return due;
}

}  // namespace

cv::Mat findConnected(const GraphRoi& view, const cv::Point& at, int radius_px) {
  cv::Mat disc = cv::Mat::zeros(view.size(), CV_8UC1);
  cv::circle(disc, at, radius_px, cv::Scalar(255), cv::FILLED);
  const ColorMixture mixture(view.lab, disc);
  if (mixture.empty()) return disc;
  const cv::Mat alike = (logDensities(mixture, view.lab) > kLikeThePoint) | disc;
  return findPiece(alike, at);
}

AnnotationTrack::AnnotationTrack(const VisionSettings& settings) {
  for (const AuthorPoint& point : settings.pointsAtStart())
    start_.on.push_back({toPixel(point), point.number, point.candidate});
  const auto is_later = [](const AuthorPoint& point) { return point.time_s != 0.0; };
  std::copy_if(settings.object_points.begin(), settings.object_points.end(),
               std::back_inserter(on_), is_later);
  for (const AuthorPoint& point : settings.not_points) {
    if (is_later(point)) {
      off_.push_back(point);
    } else {
      start_.off.push_back(toPixel(point));
    }
  }
}

Annotation AnnotationTrack::findAnnotation(const FramePair& frames) const {
  Annotation out;
  for (const AuthorPoint& point : selectDue(on_, frames))
    out.on.push_back({toPixel(point), point.number});
  for (const AuthorPoint& point : selectDue(off_, frames)) out.off.push_back(toPixel(point));
  out.masks = frames.now.key_mask;
  return out;
}

bool AnnotationTrack::hasLaterAnnotation(const FramePair& frames) const {
  const double end_s = endTime(frames.clip_time_s, frames);
  const auto later = [end_s](const AuthorPoint& point) { return point.time_s > end_s; };
  return std::any_of(on_.begin(), on_.end(), later) || std::any_of(off_.begin(), off_.end(), later);
}

NegativeColors sampleColors(const FrameContext& scene, const cv::Point& point) {
  const cv::Size picture = scene.images.color.size();
  const float depth_mm = scene.images.depth.at<float>(point);
  const int reach_px =
      depth_mm > 0
          ? std::max(2 * kPoint_px, int(kJoined_mm * pixelsPerMm(double(depth_mm), picture)))
          : 4 * kPoint_px;
  const cv::Rect box =
      cv::Rect(point.x - reach_px, point.y - reach_px, 2 * reach_px, 2 * reach_px) &
      cv::Rect({0, 0}, picture);
  const GraphRoi view = GraphRoi::makeAround(scene, box, 1e9);
  const cv::Mat region = findConnected(view, view.toRoi(point), kPoint_px);
  const double width_px = std::sqrt(double(cv::countNonZero(region))) / view.shrink;
  if (depth_mm > 0 && width_px < kLeastPatch_mm * pixelsPerMm(double(depth_mm), picture)) return {};
  const ColorHistogram clicked = ColorHistogram::fromImage(view.color, region);
  cv::Mat samples(0, 1, CV_32FC3);
  for (int v = 0; v < region.rows; ++v) {
    for (int u = 0; u < region.cols; ++u) {
      if (region.at<unsigned char>(v, u) != 0) samples.push_back(view.lab.at<cv::Vec3f>(v, u));
    }
  }
  return {clicked, samples};
}

void addSample(const NegativeColors& sample, NegativeColors& colors) {
  if (sample.samples.empty()) return;
  if (colors.samples.empty()) {
    colors = sample;
    return;
  }
  const int rows = sample.samples.rows;
  const double share = double(rows) / (rows + colors.samples.rows);
  colors.histogram.adapt(sample.histogram, share);
  cv::vconcat(colors.samples, sample.samples, colors.samples);
}

void addNegativeSample(const FrameContext& scene, const cv::Point& point, NegativeColors& colors) {
  addSample(sampleColors(scene, point), colors);
}

}  // namespace hapticast::server
