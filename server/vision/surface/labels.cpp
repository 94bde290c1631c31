// SPDX-License-Identifier: MIT
#include "server/vision/surface/labels.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr float kAnyStep_mm = 1e9F;

// Returns the label of the labelled neighbour nearest in depth; 0 if no neighbour is labelled.
uchar nearestLabel(const Surface& surface, const cv::Mat& labels, const cv::Point& at) {
  const cv::Rect whole(cv::Point(), labels.size());
  uchar nearest = 0;
  float smallest = kAnyStep_mm;
  for (int v = at.y - 1; v <= at.y + 1; ++v) {
    for (int u = at.x - 1; u <= at.x + 1; ++u) {
      if (!whole.contains({u, v}) || labels.at<uchar>(v, u) == 0) continue;
      const float off = std::abs(surface.depth.at<float>(v, u) - surface.depth.at<float>(at));
      if (off >= smallest) continue;
      smallest = off;
      nearest = labels.at<uchar>(v, u);
    }
  }
  return nearest;
}

}  // namespace

int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels) {
  cv::Mat all;
  cv::Mat stats;
  cv::Mat centroids;
  const int found = cv::connectedComponentsWithStats(where, all, stats, centroids, 4, CV_32S);
  std::vector<uchar> name(static_cast<std::size_t>(found), 0);
  int count = 0;
  for (int i = 1; i < found; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= smallest_px)
      name[static_cast<std::size_t>(i)] = static_cast<uchar>(++count);
  }
  labels.create(where.size(), CV_8UC1);
  for (int v = 0; v < all.rows; ++v) {
    const auto* from = all.ptr<int>(v);
    auto* to = labels.ptr<uchar>(v);
    for (int u = 0; u < all.cols; ++u) to[u] = name[static_cast<std::size_t>(from[u])];
  }
  return count;
}

std::vector<double> meanDepths(const Surface& surface, const cv::Mat& labels, int count) {
  std::vector<double> out;
  for (int i = 1; i <= count; ++i) out.push_back(cv::mean(surface.depth, labels == i)[0]);
  return out;
}

cv::Mat grownLabels(const Surface& surface, int count, const cv::Mat& seeds) {
  cv::Mat labels = seeds.clone();
  std::vector<cv::Point> left;
  cv::findNonZero(surface.mask & (labels == 0), left);
  for (std::size_t before = left.size() + 1; !left.empty() && left.size() < before;) {
    before = left.size();
    std::vector<uchar> grown;
    grown.reserve(left.size());
    for (const cv::Point& at : left) grown.push_back(nearestLabel(surface, labels, at));
    std::vector<cv::Point> still;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (grown[i] == 0) still.push_back(left[i]);
      labels.at<uchar>(left[i]) = grown[i];
    }
    left = std::move(still);
  }
  if (left.empty()) return labels;
  const std::vector<double> depths_mm = meanDepths(surface, labels, count);
  for (const cv::Point& at : left) {
    const auto off = [&](double mean) {
      return std::abs(mean - double(surface.depth.at<float>(at)));
    };
    const auto best = std::min_element(depths_mm.begin(), depths_mm.end(),
                                       [&](double a, double b) { return off(a) < off(b); });
    labels.at<uchar>(at) = static_cast<uchar>(best - depths_mm.begin() + 1);
  }
  return labels;
}

}  // namespace hapticast::server
