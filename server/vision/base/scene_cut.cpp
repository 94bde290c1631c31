// SPDX-License-Identifier: MIT
#include "server/vision/base/scene_cut.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

// Chosen: a cut changes most of the picture in brightness and in depth (bad_input_test).
constexpr int kCompared_px = 16;
constexpr double kAlike = 0.3;         // correlation of brightness
constexpr double kAlikeAlone = 0.1;    // limit for pictures without enough depth
constexpr double kChanged_mm = 50.0;   // change of depth, mm, or a twentieth of the depth
constexpr double kChangedShare = 0.3;  // of the cells that have depth in both frames
constexpr double kFewestCells = 0.1;
constexpr double kFlat = 3.0;  // levels: a picture without contrast correlates with any other

double correlation(const cv::Mat& a, const cv::Mat& b) {
  cv::Scalar mean_a, mean_b, spread_a, spread_b;
  cv::meanStdDev(a, mean_a, spread_a);
  cv::meanStdDev(b, mean_b, spread_b);
  if (spread_a[0] < kFlat || spread_b[0] < kFlat) return 1.0;
  const double together = (a - mean_a[0]).dot(b - mean_b[0]) / double(a.total());
  return together / (spread_a[0] * spread_b[0]);
}

// Returns the share of cells whose depth changed; below 0 if too few cells have depth.
double changedDepth(const cv::Mat& a, const cv::Mat& b) {
  int both = 0;
  int changed = 0;
  for (int v = 0; v < a.rows; ++v) {
    for (int u = 0; u < a.cols; ++u) {
      const auto before = double(a.at<float>(v, u));
      const auto now = double(b.at<float>(v, u));
      if (before <= 0 || now <= 0) continue;
      ++both;
      changed += std::abs(now - before) > std::max(kChanged_mm, 0.05 * before) ? 1 : 0;
    }
  }
  return both < kFewestCells * double(a.total()) ? -1.0 : double(changed) / both;
}

}  // namespace

bool SceneCuts::next(const FrameImages& images) {
  const cv::Size size(std::max(2, images.gray.cols / kCompared_px),
                      std::max(2, images.gray.rows / kCompared_px));
  cv::Mat gray;
  cv::Mat depth;
  cv::resize(images.gray, gray, size, 0, 0, cv::INTER_AREA);
  gray.convertTo(gray, CV_32F);
  cv::resize(images.depth, depth, size, 0, 0, cv::INTER_NEAREST);
  bool cut = false;
  if (!gray_.empty()) {
    const double alike = correlation(gray_, gray);
    const double changed = alike < kAlike ? changedDepth(depth_, depth) : 0.0;
    cut = changed < 0 ? alike < kAlikeAlone : changed > kChangedShare;
  }
  gray_ = gray;
  depth_ = depth;
  return cut;
}

}  // namespace hapticast::server
