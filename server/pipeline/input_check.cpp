// SPDX-License-Identifier: MIT
#include "server/pipeline/input_check.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr int kFirstFrames = 5;       // chosen: a sensor's first frame may be empty
constexpr double kMostMetres = 20.0;  // chosen: cameras measure less far, and no object is so near
// Measured: a hand of 3 % of the picture still has a relief at 64 x 42 px, and none below.
constexpr int kLeastLong_px = 64;
constexpr int kLeastShort_px = 48;
constexpr int kPoint_px = 2;         // chosen: half of the square around a point
constexpr int kBorderPart = 20;      // chosen: the border's width as part of the picture
constexpr float kNearer_levels = 8;  // chosen: more than the noise of 8-bit depth
// Measured on the clips of tests/data and shared/clips as 8-bit depth: at most 0.18 as they are, at
// least 0.72 inverted.
constexpr double kMostlyNear = 0.6;

void warnOfMetres(const char* flag, const std::optional<DepthRange>& range) {
  if (!range || range->far_mm > kMostMetres) return;
  spdlog::warn("{} {:g},{:g}: these are millimetres; did you mean {:g},{:g}?", flag, range->near_mm,
               range->far_mm, 1000.0 * range->near_mm, 1000.0 * range->far_mm);
}

// Returns false if the picture is tiny.
bool warnOfTinyPicture(const SourceInfo& info) {
  const auto [least, most] = std::minmax(info.width_px, info.height_px);
  if (most >= kLeastLong_px && least >= kLeastShort_px) return true;
  spdlog::warn(
      "--source {}: is {}x{} px, too small to touch anything; use a picture of at least {}x{} px",
      info.name, info.width_px, info.height_px, kLeastLong_px, kLeastShort_px);
  return false;
}

// Returns the median depth of a part of the picture.
double computeMedianIn(const cv::Mat& depth, const cv::Rect& part) {
  const cv::Mat values = depth(part & cv::Rect({0, 0}, depth.size())).clone();
  std::vector<float> depths(values.begin<float>(), values.end<float>());
  return computeMedian(depths);
}

double findObjectDepth(const cv::Mat& depth, const VisionSettings& settings) {
  std::vector<double> depths;
  for (const AuthorPoint& point : settings.pointsAtStart()) {
    const cv::Point at(static_cast<int>(point.at_px.x()), static_cast<int>(point.at_px.y()));
    const cv::Rect around(at.x - kPoint_px, at.y - kPoint_px, 2 * kPoint_px + 1, 2 * kPoint_px + 1);
    if (cv::Rect({0, 0}, depth.size()).contains(at))
      depths.push_back(computeMedianIn(depth, around));
  }
  if (!depths.empty()) return computeMedian(depths);
  const cv::Rect middle(depth.cols / 4, depth.rows / 4, std::max(1, depth.cols / 2),
                        std::max(1, depth.rows / 2));
  return computeMedianIn(depth, middle);
}

// Returns false if the depth has no surface.
bool warnOfDepth(RgbdSource& source, const VisionSettings& settings) {
  double least = HUGE_VAL;
  double most = -HUGE_VAL;
  std::vector<double> near_shares;
  for (int i = 0; i < kFirstFrames; ++i) {
    const std::optional<RgbdFrame> frame = source.read();
    if (!frame) break;
    double low = 0.0;
    double high = 0.0;
    cv::minMaxLoc(frame->depth, &low, &high);
    least = std::min(least, low);
    most = std::max(most, high);
    near_shares.push_back(shareOfNearBorder(frame->depth, settings));
  }
  source.rewind();
  const SourceInfo& info = source.info();
  if (least == most) {
    spdlog::warn(
        "--source {}: depth is {:g} in every pixel of the first {} frames, so there is nothing to "
        "touch; check that the depth images belong to this clip and are not empty",
        info.name, most, near_shares.size());
    return false;
  }
  if (info.depth_kind == DepthKind::kHeight && !near_shares.empty() &&
      computeMedian(near_shares) >= kMostlyNear) {
    spdlog::warn(
        "--source {}: its depth looks inverted, because the border is nearer than the object; "
        "use "
        "--depth-near dark",
        info.name);
  }
  return true;
}

}  // namespace

double shareOfNearBorder(const cv::Mat& depth, const VisionSettings& settings) {
  const double limit = findObjectDepth(depth, settings) + double{kNearer_levels};
  const int wide_px = std::max(1, std::min(depth.cols, depth.rows) / kBorderPart);
  cv::Mat border = cv::Mat::zeros(depth.size(), CV_8UC1);
  const int half = std::max(1, depth.rows / 2);
  border.rowRange(0, half).setTo(255);
  if (half > wide_px && depth.cols > 2 * wide_px)
    border(cv::Rect(wide_px, wide_px, depth.cols - 2 * wide_px, half - wide_px)).setTo(0);
  const cv::Mat near = (depth > limit) & border;
  return double(cv::countNonZero(near)) / double(cv::countNonZero(border));
}

bool warnOfUnlikelyInput(RgbdSource& source, const VisionSettings& settings) {
  warnOfMetres("--map-range", settings.map_range);
  warnOfMetres("--depth-range", settings.depth_range);
  if (!warnOfTinyPicture(source.info())) return false;
  return source.info().live || warnOfDepth(source, settings);
}

}  // namespace hapticast::server
