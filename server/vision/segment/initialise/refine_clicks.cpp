// SPDX-License-Identifier: MIT
#include "server/vision/segment/initialise/refine_clicks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/appearance/graph_cut.hpp"
#include "server/vision/segment/initialise/candidates.hpp"

namespace hapticast::server {

namespace {

// Tuned on drawn scenes of objects in hands.
constexpr double kSays_mm = 30.0;    // up to here a point outweighs its colours
constexpr double kMeant_mm = 100.0;  // up to here a point means the pixels connected to it
constexpr double kMostAdded = 0.5;   // chosen, of the mask: a point means a missing part
constexpr int kWordMargin_px = 30;

// Chosen: a point this near to the contour, in multiples of its distance, means a part so thin.
constexpr double kThinPart = 3.0;
// Measured, of the score: a correction that adds a hand gained at most 0.03, or lost.
constexpr double kLeastGain = 0.1;

// A point of a correction, px of the view.
struct Clicked {
  cv::Point at;
  int radius;    // of the disc that the point means for certain
  double reach;  // how far it outweighs the colours
};

// Data of a correction in one small view.
struct Correction {
  GraphRoi view;
  cv::Mat old;                 // 255
  cv::Mat clicked_positive;    // 255: discs
  cv::Mat connected_positive;  // 255: the discs and their connected regions in colour and depth
  cv::Mat connected_negative;  // 255: the discs and their connected regions
  cv::Mat clicked_negative;    // 255
  cv::Mat held;                // 255: discs of earlier positive points
  cv::Mat nearby_positive, nearby_negative;  // CV_32FC1: 1 at a point, 0 beyond its reach
};

int discRadius(const GraphRoi& view) {
  return std::max(1, int(std::lround(kPoint_px * view.shrink)));
}

std::vector<cv::Point> positions(const std::vector<ObjectPoint>& points) {
  std::vector<cv::Point> out;
  out.reserve(points.size());
  for (const ObjectPoint& point : points) out.push_back(point.at_px);
  return out;
}

// Returns the points inside the view. A point near the contour of `old` means a thin part: a rim or
// a sliver.
std::vector<Clicked> measureClicks(const GraphRoi& view, const cv::Mat& old,
                                   const std::vector<cv::Point>& points, double px_per_mm) {
  cv::Mat inner;
  cv::Mat outer;
  cv::distanceTransform(old, inner, cv::DIST_L2, 5);
  cv::distanceTransform(old == 0, outer, cv::DIST_L2, 5);
  std::vector<Clicked> out;
  for (const cv::Point& point : points) {
    if (!view.box.contains(point)) continue;
    const cv::Point at = view.toRoi(point);
    const auto thin_px = double(std::max(inner.at<float>(at), outer.at<float>(at)));
    out.push_back({at, std::clamp(int(thin_px), 1, discRadius(view)),
                   std::max(3.0, std::min(kSays_mm * px_per_mm, kThinPart * thin_px))});
  }
  return out;
}

cv::Mat drawDiscs(const GraphRoi& view, const std::vector<Clicked>& points) {
  cv::Mat out = cv::Mat::zeros(view.size(), CV_8UC1);
  for (const Clicked& point : points)
    cv::circle(out, point.at, point.radius, cv::Scalar(255), cv::FILLED);
  return out;
}

cv::Mat computeNearness(const cv::Mat& clicked, double reach_px) {
  cv::Mat distance;
  cv::distanceTransform(clicked == 0, distance, cv::DIST_L2, 5);
  return cv::max(1.0 - distance / reach_px, 0.0);
}

// Returns the region connected to a positive point: similar in colour, within `reach_px`, at most
// as far in depth, on no plane.
cv::Mat growRegion(const GraphRoi& view, const Clicked& point, double px_per_mm, double reach_px) {
  cv::Mat out = findConnected(view, point.at, point.radius);
  const auto depth_mm = double(view.depth.at<float>(point.at));
  cv::Mat off = view.plane.clone();
  if (depth_mm > 0)
    off |= (view.depth > 0) & (cv::abs(view.depth - depth_mm) > reach_px / px_per_mm);
  out.setTo(0, off);
  cv::Mat within = cv::Mat::zeros(out.size(), CV_8UC1);
  cv::circle(within, point.at, std::max(point.radius, int(reach_px)), cv::Scalar(255), cv::FILLED);
  out &= within;
  cv::circle(out, point.at, point.radius, cv::Scalar(255), cv::FILLED);
  return findPiece(out, point.at);
}

// Returns the region that a positive point adds to the mask `old`. Where the colours are also those
// of other things, the region is larger than the object. Then only pixels near the point count.
cv::Mat findAddedRegion(const GraphRoi& view, const cv::Mat& old, const Clicked& point,
                        double px_per_mm) {
  const double most_px = kMeant_mm * px_per_mm;
  const double far_px = std::min(most_px, point.reach * kMeant_mm / kSays_mm);
  cv::Mat region = growRegion(view, point, px_per_mm, far_px);
  if (cv::countNonZero(region & ~old) <= kMostAdded * cv::countNonZero(old)) return region;
  return growRegion(view, point, px_per_mm, point.reach);
}

Correction prepareCorrection(const FrameContext& scene, const cv::Mat& mask,
                             const Annotation& annotation, const std::vector<cv::Point>& held) {
  const cv::Size picture = mask.size();
  cv::Rect box = findBoxAround(mask, kWordMargin_px);
  for (const ObjectPoint& point : annotation.on) {
    box |= cv::Rect(point.at_px.x - kWordMargin_px, point.at_px.y - kWordMargin_px,
                    2 * kWordMargin_px, 2 * kWordMargin_px);
  }
  Correction out;
  out.view =
      GraphRoi::makeWithValleys(scene, box & cv::Rect({0, 0}, picture), kCutOfCorrection.most_px);
  out.old = out.view.shrinkImage(mask);
  const double depth_mm = medianDepth(out.view.depth, out.old, 1);
  const double px_per_mm = pixelsPerMm(depth_mm, picture) * out.view.shrink;
  const auto measured = [&](const std::vector<cv::Point>& points) {
    return measureClicks(out.view, out.old, points, px_per_mm);
  };
  const std::vector<Clicked> on = measured(positions(annotation.on));
  const std::vector<Clicked> off = measured(annotation.off);
  out.clicked_positive = drawDiscs(out.view, on);
  out.clicked_negative = drawDiscs(out.view, off);
  out.held = drawDiscs(out.view, measured(held));
  out.connected_positive = out.clicked_positive.clone();
  out.connected_negative = out.clicked_negative.clone();
  out.nearby_positive = cv::Mat::zeros(out.view.size(), CV_32FC1);
  out.nearby_negative = out.nearby_positive.clone();
  for (const Clicked& point : off) {
    out.connected_negative |= findConnected(out.view, point.at, point.radius);
    const cv::Mat near = computeNearness(drawDiscs(out.view, {point}), point.reach);
    out.nearby_negative = cv::max(out.nearby_negative, near);
  }
  for (const Clicked& point : on) {
    const cv::Mat region = findAddedRegion(out.view, out.old, point, px_per_mm);
    out.connected_positive |= region;
    out.nearby_positive = cv::max(out.nearby_positive, computeNearness(region, point.reach));
  }
  return out;
}

// Returns the log likelihood ratio of the first colours against the second colours for each pixel.
// 0 if either set is empty.
cv::Mat preferFirst(const cv::Mat& lab, const cv::Mat& first, const cv::Mat& second) {
  const ColorMixture a(lab, first);
  const ColorMixture b(lab, second);
  if (a.empty() || b.empty()) return cv::Mat::zeros(lab.size(), CV_32FC1);
  const cv::Mat out = logDensities(a, lab) - logDensities(b, lab);
  return cv::min(cv::max(out, -kCutOfCorrection.most_color), kCutOfCorrection.most_color);
}

CutTerms computeTerms(const Correction& c) {
  const cv::Mat object = (c.old & ~c.connected_negative) | c.connected_positive;
  const cv::Mat around = (c.old == 0) & (c.nearby_positive <= 0.0F);
  const cv::Mat not_color = preferFirst(c.view.lab, object, c.clicked_negative);
  cv::Mat own_color = preferFirst(c.view.lab, object, around);
  if (cv::countNonZero(c.connected_positive) > 0)
    own_color = cv::max(own_color, preferFirst(c.view.lab, c.connected_positive, around));
  cv::Mat out(c.old.size(), CV_32FC1);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      const auto on = double(c.nearby_positive.at<float>(v, u));
      const auto off = double(c.nearby_negative.at<float>(v, u));
      const bool inside = c.old.at<unsigned char>(v, u) != 0;
      const auto stays = double(inside ? kCutOfCorrection.old_mask : -kCutOfCorrection.old_mask);
      double sum = stays * (1.0 - std::max(on, off));
      sum += double(kCutOfCorrection.point) * (on - off);
      sum += std::max(off, inside ? double(kCutOfCorrection.far_color) : 0.0) *
             double(not_color.at<float>(v, u));
      sum += on * double(own_color.at<float>(v, u));
      out.at<float>(v, u) = static_cast<float>(sum);
    }
  }
  return {out, (c.clicked_positive | c.held) & ~c.clicked_negative, c.clicked_negative};
}

// Returns the pieces with a positive point, and all pieces larger than a tenth of the largest
// piece.
cv::Mat selectPieces(const Correction& c, const cv::Mat& cut) {
  const auto [labels, areas_px] = findPieces(cut);
  const int largest_px = *std::max_element(areas_px.begin(), areas_px.end());
  cv::Mat out = cv::Mat::zeros(cut.size(), CV_8UC1);
  for (std::size_t i = 1; i < areas_px.size(); ++i) {
    const cv::Mat piece = labels == double(i);
    const bool is_clicked = cv::countNonZero(piece & (c.clicked_positive | c.held)) > 0;
    if (is_clicked || areas_px[i] > largest_px / 10) out |= piece;
  }
  return out;
}

}  // namespace

cv::Mat refineWithClicks(const FrameContext& scene, const cv::Mat& mask,
                         const Annotation& annotation, const std::vector<cv::Point>& held,
                         double most_px) {
  const Correction c = prepareCorrection(scene, mask, annotation, held);
  const cv::Mat cut = minimumCut(computeTerms(c), c.view, scene.noise, kCutOfCorrection);
  cv::Mat out = c.view.placeInPicture(selectPieces(c, cut), mask.size());
  const bool grows = annotation.off.empty() && cv::countNonZero(out) > most_px;
  if (!grows || objectness(scene, out) > objectness(scene, mask) + kLeastGain) return out;
  return mask | c.view.placeInPicture(c.clicked_positive, mask.size());
}

}  // namespace hapticast::server
