// SPDX-License-Identifier: MIT
#include "server/vision/segment/initialise/depth_components.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"

namespace hapticast::server {

namespace {

constexpr double kHidden_mm = 90.0;   // chosen: width of a hand
constexpr float kBehind_mm = 20.0F;   // chosen
constexpr double kLeastPiece = 0.02;  // chosen, of the main piece
constexpr double kMostPiece = 2.0;    // likewise
constexpr int kSmallestHole = 80;     // chosen: fills holes smaller than this part of the view

std::vector<cv::Point> traceRim(const cv::Mat& piece) {
  cv::Mat inner;
  cv::erode(piece, inner, cv::Mat::ones(3, 3, CV_8UC1));
  std::vector<cv::Point> out;
  cv::findNonZero(piece & ~inner, out);
  return out;
}

// Returns whether an occluder may hide the joint of piece and mask: they are near each other, and
// no pixel between them lies behind both.
bool connectedBehind(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& piece,
                     double px_per_mm) {
  cv::Point from;
  cv::Point to;
  int nearest = 1 << 30;
  const std::vector<cv::Point> rim = traceRim(mask);
  for (const cv::Point& b : traceRim(piece)) {
    for (const cv::Point& a : rim) {
      const int square = (a - b).dot(a - b);
      if (square >= nearest) continue;
      nearest = square;
      from = a;
      to = b;
    }
  }
  if (std::sqrt(nearest) > kHidden_mm * px_per_mm) return false;
  const float deepest = std::max(view.depth.at<float>(from), view.depth.at<float>(to)) + kBehind_mm;
  const int steps = std::max(2, int(std::sqrt(nearest)));
  for (int i = 1; i < steps; ++i) {
    const cv::Point at = from + (to - from) * (double(i) / steps);
    if (view.plane.at<unsigned char>(at) != 0 || view.depth.at<float>(at) > deepest) return false;
  }
  return true;
}

}  // namespace

cv::Mat mergeOccludedParts(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& main,
                           double px_per_mm) {
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const cv::Mat others = mask & ~main;
  const int count = cv::connectedComponentsWithStats(others, labels, stats, centroids, 4, CV_32S);
  cv::Mat out = main.clone();
  std::vector<cv::Mat> left;
  left.reserve(static_cast<std::size_t>(count));
  for (int i = 1; i < count; ++i) {
    const double share = double(stats.at<int>(i, cv::CC_STAT_AREA)) / cv::countNonZero(main);
    if (share < kLeastPiece || share > kMostPiece) continue;
    const cv::Mat piece = labels == i;
    if (clearOfBorder(piece)) left.push_back(piece);
  }
  for (bool grows = true; grows;) {
    const std::size_t before = left.size();
    std::erase_if(left, [&](const cv::Mat& piece) {
      if (!connectedBehind(view, out, piece, px_per_mm)) return false;
      out |= piece;
      return true;
    });
    grows = left.size() < before;
  }
  return withoutHoles(out, out.rows * out.cols / kSmallestHole);
}

}  // namespace hapticast::server
