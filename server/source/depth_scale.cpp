// SPDX-License-Identifier: MIT
#include "server/source/depth_scale.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

bool sameAspect(cv::Size a, cv::Size b) {
  if (a.empty() || b.empty()) return false;
  const double first = static_cast<double>(a.width) * b.height;
  const double second = static_cast<double>(b.width) * a.height;
  constexpr double kTolerance = 0.01;  // sizes of video are rounded to even numbers
  return std::abs(first - second) <= kTolerance * std::max(first, second);
}

cv::Mat scaleDepth(const cv::Mat& depth, cv::Size size) {
  if (depth.size() == size) return depth;
  cv::Mat scaled;
  cv::resize(depth, scaled, size, 0.0, 0.0, cv::INTER_NEAREST_EXACT);
  return scaled;
}

void logScaledDepth(const std::string& place, cv::Size from, cv::Size to) {
  spdlog::info("{}: depth of {} x {} is scaled to {} x {}", place, from.width, from.height,
               to.width, to.height);
}

}  // namespace hapticast::server
