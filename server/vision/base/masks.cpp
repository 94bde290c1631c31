// SPDX-License-Identifier: MIT
#include "server/vision/base/masks.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

// A disc is decomposed into a square and successive crosses, which form an octagon of this radius
// in a tenth of the time (measured). Larger discs use a distance transform, whose time does not
// depend on the radius. Chosen: each limit is where the next method becomes faster.
constexpr int kLargestKernel_px = 2;
constexpr int kLargestOctagon_px = 8;

cv::Mat disc(int radius_px) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius_px + 1, 2 * radius_px + 1});
}

cv::Mat applyOctagon(const cv::Mat& mask, int radius_px, int operation) {
  const int square = (radius_px * 2 + 2) / 5;
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  cv::Mat out;
  cv::morphologyEx(mask, out, operation, cross, {-1, -1}, radius_px - square);
  cv::morphologyEx(out, out, operation, cv::Mat::ones(2 * square + 1, 2 * square + 1, CV_8UC1));
  return out;
}

}  // namespace

cv::Rect findBoxAround(const cv::Mat& mask, int margin_px) {
  return growRect(cv::boundingRect(mask), margin_px, mask.size());
}

cv::Rect growRect(const cv::Rect& rect, int margin_px, const cv::Size& size) {
  if (rect.empty()) return {};
  const cv::Rect larger(rect.x - margin_px, rect.y - margin_px, rect.width + 2 * margin_px,
                        rect.height + 2 * margin_px);
  return larger & cv::Rect(cv::Point(), size);
}

double computeOverlap(const cv::Mat& a, const cv::Mat& b) {
  return cv::countNonZero(a & b) / std::max(1.0, double(cv::countNonZero(a | b)));
}

cv::Point2d computeCentroid(const cv::Moments& moments, const cv::Point& corner) {
  if (!(moments.m00 > 0)) return {0, 0};
  return {corner.x + moments.m10 / moments.m00, corner.y + moments.m01 / moments.m00};
}

cv::Mat erodeBy(const cv::Mat& mask, int radius_px) {
  cv::Mat out;
  if (radius_px <= kLargestKernel_px) {
    cv::erode(mask, out, disc(radius_px));
    return out;
  }
  if (radius_px <= kLargestOctagon_px) return applyOctagon(mask, radius_px, cv::MORPH_ERODE);
  cv::distanceTransform(mask, out, cv::DIST_L2, 3);
  return out > radius_px;
}

cv::Mat dilateBy(const cv::Mat& mask, int radius_px) {
  cv::Mat out;
  if (radius_px <= kLargestKernel_px) {
    cv::dilate(mask, out, disc(radius_px));
    return out;
  }
  if (radius_px <= kLargestOctagon_px) return applyOctagon(mask, radius_px, cv::MORPH_DILATE);
  if (cv::countNonZero(mask) == 0) return mask.clone();
  cv::distanceTransform(mask == 0, out, cv::DIST_L2, 3);
  return out <= radius_px;
}

cv::Mat fillHolesOf(const cv::Mat& mask, int largest_px) {
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count =
      cv::connectedComponentsWithStats(mask == 0, labels, stats, centroids, 4, CV_32S);
  std::vector<unsigned char> fill(static_cast<std::size_t>(count), 0);
  for (int i = 1; i < count; ++i) {
    const cv::Rect box(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                       stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    const bool at_border =
        box.x == 0 || box.y == 0 || box.br().x == mask.cols || box.br().y == mask.rows;
    fill[static_cast<std::size_t>(i)] =
        !at_border && stats.at<int>(i, cv::CC_STAT_AREA) < largest_px;
  }
  cv::Mat out = mask.clone();
  for (int v = 0; v < out.rows; ++v) {
    const auto* label = labels.ptr<int>(v);
    auto* to = out.ptr<unsigned char>(v);
    for (int u = 0; u < out.cols; ++u) {
      if (fill[static_cast<std::size_t>(label[u])] != 0) to[u] = 255;
    }
  }
  return out;
}

int Pieces::largest() const {
  return static_cast<int>(std::max_element(areas_px.begin(), areas_px.end()) - areas_px.begin());
}

Pieces findPieces(const cv::Mat& mask) {
  Pieces out;
  cv::Mat stats;
  cv::Mat centroids;
  cv::connectedComponentsWithStats(mask, out.labels, stats, centroids, 4, CV_32S);
  stats.col(cv::CC_STAT_AREA).copyTo(out.areas_px);
  out.areas_px.front() = 0;
  return out;
}

cv::Mat findPiece(const cv::Mat& mask, const cv::Point& at) {
  cv::Mat labels;
  cv::connectedComponents(mask, labels, 4, CV_32S);
  return (labels == labels.at<int>(at)) & mask;
}

bool contains(const cv::Mat& mask, const cv::Point& at) {
  return cv::Rect({0, 0}, mask.size()).contains(at) && mask.at<unsigned char>(at) != 0;
}

cv::Point findDeepestPoint(const cv::Mat& mask) {
  cv::Mat framed;
  cv::copyMakeBorder(mask, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat distance;
  cv::distanceTransform(framed, distance, cv::DIST_L2, 3);
  cv::Point deepest;
  cv::minMaxLoc(distance, nullptr, nullptr, nullptr, &deepest);
  return deepest - cv::Point(1, 1);
}

double medianDepth(const cv::Mat& depth, const cv::Mat& mask, int step) {
  std::vector<double> values;
  for (int v = 0; v < depth.rows; v += step) {
    for (int u = 0; u < depth.cols; u += step) {
      const float z = depth.at<float>(v, u);
      if (mask.at<unsigned char>(v, u) != 0 && z > 0) values.push_back(double(z));
    }
  }
  return computeMedian(values);
}

}  // namespace hapticast::server
