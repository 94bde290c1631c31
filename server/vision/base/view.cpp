// SPDX-License-Identifier: MIT
#include "server/vision/base/view.hpp"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>

namespace hapticast::server {

namespace {

constexpr float kLargestDepth_mm = 1e5F;

cv::Mat workingDepth(const cv::Mat& depth, const SourceInfo& info) {
  cv::Mat out(depth.size(), CV_32FC1);
  const DepthRange range = info.depth_range.value_or(kHeightRange);
  const auto step = static_cast<float>((range.far_mm - range.near_mm) / 255.0);
  const auto far_mm = static_cast<float>(range.far_mm);
  const bool heights = info.depth_kind == DepthKind::kHeight;
  for (int v = 0; v < depth.rows; ++v) {
    const auto* in = depth.ptr<float>(v);
    auto* to = out.ptr<float>(v);
    for (int u = 0; heights && u < depth.cols; ++u)
      to[u] = in[u] >= 0.0F && in[u] <= 255.0F ? far_mm - step * in[u] : 0.0F;
    for (int u = 0; !heights && u < depth.cols; ++u)
      to[u] = in[u] > 0.0F && in[u] < kLargestDepth_mm ? in[u] : 0.0F;
  }
  return out;
}

std::string sizeText(const cv::Mat& image) {
  return std::to_string(image.cols) + "x" + std::to_string(image.rows);
}

}  // namespace

View makeView(const RgbdFrame& frame, const SourceInfo& info) {
  const cv::Size size(info.width_px, info.height_px);
  const std::string where = info.name + " frame " + std::to_string(frame.index) + ": ";
  if (frame.color.type() != CV_8UC3 || frame.color.size() != size) {
    throw SourceError(where + "colour is " + sizeText(frame.color) + ", announced was " +
                      std::to_string(size.width) + "x" + std::to_string(size.height) + " BGR");
  }
  if (frame.depth.type() != CV_32FC1 || frame.depth.size() != size) {
    throw SourceError(where + "depth is " + sizeText(frame.depth) +
                      ", it must be as large as colour");
  }
  if (!frame.mask.empty() && (frame.mask.type() != CV_8UC1 || frame.mask.size() != size)) {
    throw SourceError(where + "mask is " + sizeText(frame.mask) +
                      ", it must be 8-bit and as large as colour");
  }
  View view{frame.color, {}, workingDepth(frame.depth, info), frame.mask};
  cv::cvtColor(frame.color, view.gray, cv::COLOR_BGR2GRAY);
  return view;
}

cv::Rect grown(const cv::Rect& rect, int margin_px, const cv::Size& size) {
  if (rect.empty()) return {};
  const cv::Rect larger(rect.x - margin_px, rect.y - margin_px, rect.width + 2 * margin_px,
                        rect.height + 2 * margin_px);
  return larger & cv::Rect(cv::Point(), size);
}

bool equalImages(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  const std::size_t bytes = static_cast<std::size_t>(a.cols) * a.elemSize();
  for (int v = 0; v < a.rows; ++v) {
    if (std::memcmp(a.ptr(v), b.ptr(v), bytes) != 0) return false;
  }
  return true;
}

cv::Rect boxAround(const cv::Mat& mask, int margin_px) {
  return grown(cv::boundingRect(mask), margin_px, mask.size());
}

namespace {

cv::Mat disc(int radius_px) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius_px + 1, 2 * radius_px + 1});
}

// A disc taken apart: a square and crosses one after the other make an octagon of this radius, in
// a tenth of the time. Large ones by distance transform: linear whatever the radius.
constexpr int kLargestKernel_px = 2;
constexpr int kLargestOctagon_px = 8;

void byOctagon(const cv::Mat& mask, int radius_px, int operation, cv::Mat& out) {
  const int square = (radius_px * 2 + 2) / 5;
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  cv::morphologyEx(mask, out, operation, cross, {-1, -1}, radius_px - square);
  cv::morphologyEx(out, out, operation, cv::Mat::ones(2 * square + 1, 2 * square + 1, CV_8UC1));
}

}  // namespace

cv::Mat erodedBy(const cv::Mat& mask, int radius_px) {
  cv::Mat out;
  if (radius_px <= kLargestKernel_px) {
    cv::erode(mask, out, disc(radius_px));
    return out;
  }
  if (radius_px <= kLargestOctagon_px) {
    byOctagon(mask, radius_px, cv::MORPH_ERODE, out);
    return out;
  }
  cv::distanceTransform(mask, out, cv::DIST_L2, 3);
  return out > radius_px;
}

cv::Mat dilatedBy(const cv::Mat& mask, int radius_px) {
  cv::Mat out;
  if (radius_px <= kLargestKernel_px) {
    cv::dilate(mask, out, disc(radius_px));
    return out;
  }
  if (radius_px <= kLargestOctagon_px) {
    byOctagon(mask, radius_px, cv::MORPH_DILATE, out);
    return out;
  }
  if (cv::countNonZero(mask) == 0) return mask.clone();
  cv::distanceTransform(mask == 0, out, cv::DIST_L2, 3);
  return out <= radius_px;
}

void fillHoles(cv::Mat& mask, int largest_px) {
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count =
      cv::connectedComponentsWithStats(mask == 0, labels, stats, centroids, 4, CV_32S);
  std::vector<unsigned char> fill(static_cast<std::size_t>(count), 0);
  bool any = false;
  for (int i = 1; i < count; ++i) {
    const cv::Rect box(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                       stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    const bool at_border =
        box.x == 0 || box.y == 0 || box.br().x == mask.cols || box.br().y == mask.rows;
    fill[static_cast<std::size_t>(i)] =
        !at_border && stats.at<int>(i, cv::CC_STAT_AREA) < largest_px;
    any = any || fill[static_cast<std::size_t>(i)] != 0;
  }
  if (!any) return;
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (fill[static_cast<std::size_t>(labels.at<int>(v, u))] != 0)
        mask.at<unsigned char>(v, u) = 255;
    }
  }
}

double medianOf(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace hapticast::server
