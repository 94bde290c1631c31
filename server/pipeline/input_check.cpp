// SPDX-License-Identifier: MIT
#include "server/pipeline/input_check.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/text.hpp"
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

/// A unit that programs write, and its size relative to the unit that the server assumes.
struct UnitGuess {
  double factor;
  const char* whose;
};

/// Returns the units with which the depth `median_mm` would be one of an object to touch, as
/// "--depth-unit 0.1 (RealSense) or --depth-unit 0.2 (TUM, ORB-SLAM)".
std::string listLikelyUnits(double median_mm, double mm_per_unit) {
  constexpr std::array kGuesses{UnitGuess{0.2, "1/5000 m, as TUM and ORB-SLAM write"},
                                UnitGuess{0.1, "0.1 mm, as RealSense writes"},
                                UnitGuess{0.25, "1/4000 m"},
                                UnitGuess{1e-3, "mm as floats"},
                                UnitGuess{16.0, "16 bits that FFmpeg squeezed into 12"},
                                UnitGuess{64.0, "16 bits that FFmpeg squeezed into 10"},
                                UnitGuess{256.0, "16 bits that a program squeezed into 8"},
                                UnitGuess{10.0, "cm"},
                                UnitGuess{1e3, "metres"}};
  constexpr double kNearest_mm = 300.0;  // chosen: objects to touch are about an arm away
  constexpr double kFarthest_mm = 3000.0;
  std::vector<std::string> likely;
  for (const UnitGuess& guess : kGuesses) {
    const double depth_mm = guess.factor * median_mm;
    if (depth_mm < kNearest_mm || depth_mm > kFarthest_mm) continue;
    likely.push_back(
        fmt::format("--depth-unit {:g} ({})", guess.factor * mm_per_unit, guess.whose));
  }
  return join(likely, " or ");
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

/// Logs a warning if nearly all of `depths_mm` are nearer or farther than objects to touch.
void warnOfUnit(std::vector<float> depths_mm, const SourceInfo& info) {
  constexpr double kNear_mm = 150.0;  // chosen: cameras of depth measure no nearer
  constexpr double kFar_mm = 6000.0;  // chosen: an object that far has a relief of few pixels
  constexpr double kNearlyAll = 0.95;
  if (depths_mm.empty()) return;
  std::sort(depths_mm.begin(), depths_mm.end());
  const auto at = [&depths_mm](double share) {
    return double(depths_mm[static_cast<std::size_t>(share * double(depths_mm.size() - 1))]);
  };
  const bool near = at(kNearlyAll) < kNear_mm;
  if (!near && at(1.0 - kNearlyAll) <= kFar_mm) return;
  const std::string likely = listLikelyUnits(at(0.5), info.mm_per_unit);
  spdlog::warn(
      "--source {}: nearly all depths are {} ({:.4g} to {:.4g} mm); if the unit is "
      "another one, use {}",
      info.name, near ? "below 150 mm" : "above 6 m", at(1.0 - kNearlyAll), at(kNearlyAll),
      likely.empty() ? "--depth-unit MM" : likely);
}

/// Depths of the first frames of a clip.
struct FirstDepths {
  double least = HUGE_VAL;
  double most = -HUGE_VAL;
  std::vector<double> near_shares;  ///< shareOfNearBorder() of each frame
  std::vector<float> depths;        ///< measured ones, a few thousand of each frame
};

FirstDepths readFirstDepths(RgbdSource& source, const VisionSettings& settings) {
  constexpr std::size_t kSamples = 5000;  // of each frame; chosen
  FirstDepths first;
  for (int i = 0; i < kFirstFrames; ++i) {
    const std::optional<RgbdFrame> frame = source.read();
    if (!frame) break;
    double low = 0.0;
    double high = 0.0;
    cv::minMaxLoc(frame->depth, &low, &high);
    first.least = std::min(first.least, low);
    first.most = std::max(first.most, high);
    first.near_shares.push_back(shareOfNearBorder(frame->depth, settings));
    const std::size_t step = std::max<std::size_t>(1, frame->depth.total() / kSamples);
    for (std::size_t at = 0; at < frame->depth.total(); at += step) {
      const float depth = frame->depth.at<float>(static_cast<int>(at));
      if (depth > 0.0F) first.depths.push_back(depth);
    }
  }
  source.rewind();
  return first;
}

/// Logs a warning if depth of 8 bits uses a few levels only.
void warnOfFewLevels(const FirstDepths& first, const SourceInfo& info) {
  constexpr double kFewLevels = 12.0;  // chosen
  if (first.most - first.least >= kFewLevels) return;
  spdlog::warn(
      "--source {}: its depth has only the levels {:g} to {:g} of 255; it was probably "
      "depth of 16 bits before, so write it with 16 bits (ffmpeg -i FILE -pix_fmt "
      "gray16le -c:v ffv1 OUT.mkv)",
      info.name, first.least, first.most);
}

// Returns false if the depth has no surface.
bool warnOfDepth(RgbdSource& source, const VisionSettings& settings) {
  FirstDepths first = readFirstDepths(source, settings);
  const SourceInfo& info = source.info();
  if (first.least == first.most) {
    spdlog::warn(
        "--source {}: depth is {:g} in every pixel of the first {} frames, so there is nothing to "
        "touch; check that the depth images belong to this clip and are not empty",
        info.name, first.most, first.near_shares.size());
    return false;
  }
  if (info.depth_kind == DepthKind::kMetric) {
    warnOfUnit(first.depths, info);
    return true;
  }
  warnOfFewLevels(first, info);
  if (!first.near_shares.empty() && computeMedian(first.near_shares) >= kMostlyNear) {
    spdlog::warn(
        "--source {}: its depth looks inverted, because the border is nearer than the object; use "
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

void warnOfNoObject(const Vision& vision, const std::string& source) {
  if (vision.mapped()) return;
  spdlog::warn(
      "--source {}: no object was found, so there is nothing to touch; name one with --object U,V",
      source);
}

}  // namespace hapticast::server
