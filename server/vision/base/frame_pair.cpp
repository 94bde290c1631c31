// SPDX-License-Identifier: MIT
#include "server/vision/base/frame_pair.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "server/vision/base/edge_sharpening.hpp"

namespace hapticast::server {

namespace {

constexpr float kLargestDepth_mm = 1e5F;  // chosen: beyond the reach of depth cameras

// Returns whether all depths are valid and in mm, so that the picture is used as it is.
bool isWorkingDepth(const cv::Mat& depth) {
  for (int v = 0; v < depth.rows; ++v) {
    const auto* row = depth.ptr<float>(v);
    int invalid = 0;
    for (int u = 0; u < depth.cols; ++u)
      invalid += int(row[u] >= 0.0F) & int(row[u] < kLargestDepth_mm) ? 0 : 1;
    if (invalid > 0) return false;
  }
  return true;
}

cv::Mat workingDepth(const cv::Mat& depth, const SourceInfo& info) {
  if (info.depth_kind != DepthKind::kHeight && isWorkingDepth(depth)) return depth;
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

FrameImages makeFrameImages(const RgbdFrame& frame, const SourceInfo& info) {
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
  FrameImages out{frame.color, {}, workingDepth(frame.depth, info), {}, {}};
  (info.key_masks ? out.key_mask : out.mask) = frame.mask;
  cv::cvtColor(frame.color, out.gray, cv::COLOR_BGR2GRAY);
  return out;
}

bool equalImages(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size()) return false;
  const std::size_t bytes = static_cast<std::size_t>(a.cols) * a.elemSize();
  for (int v = 0; v < a.rows; ++v) {
    if (std::memcmp(a.ptr(v), b.ptr(v), bytes) != 0) return false;
  }
  return true;
}

bool equalImages(const FrameImages& a, const FrameImages& b) {
  return equalImages(a.color, b.color) && equalImages(a.depth, b.depth) &&
         equalImages(a.mask, b.mask) && equalImages(a.key_mask, b.key_mask);
}

FramePair FramePairs::push(const RgbdFrame& frame, double time_s, const cv::Mat& objects) {
  const FrameImages raw = makeFrameImages(frame, info_);
  pair_.last = std::exchange(pair_.now, raw);
  const bool first = pair_.last.color.empty();
  pair_.index = frame.index;
  pair_.last_clip_time_s =
      first || frame.clip_time_s < pair_.clip_time_s ? -1.0 : pair_.clip_time_s;
  pair_.clip_time_s = frame.clip_time_s;
  pair_.own_px = info_.own_px;
  pair_.frame_s = 1.0 / info_.fps;
  pair_.has_key_masks = info_.key_masks;
  pair_.cut = cuts_.next(raw);
  if (pair_.cut) {
    pair_.last = {};
    flicker_ = DepthScaleAlignment(info_.depth_kind, info_.estimated);
  }
  if (first || pair_.cut) {
    pair_.noise = measureNoise(raw.depth);
    pair_.noise.eight_bit = info_.depth_kind == DepthKind::kHeight;
  }
  pair_.identical = compare_ && !pair_.last.color.empty() && equalImages(raw, raw_);
  if (pair_.identical) {
    pair_.now.depth = pair_.last.depth;
  } else {
    const bool soft = info_.estimated != EstimatedDepth::kNone;
    pair_.now.depth = flicker_.steady(soft ? sharpenEdges(raw.depth, raw.color) : raw.depth,
                                      raw.gray, pair_.cut ? cv::Mat() : objects);
  }
  pair_.noise.flickers = flicker_.shown();
  raw_ = raw;
  pair_.interval_s = time_s - std::exchange(time_s_, time_s);
  return pair_;
}

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
double measureDepthChange(const cv::Mat& a, const cv::Mat& b) {
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
  const cv::Mat usual = sampleEvery(images.gray, largestReduction(images.gray.size()));
  cv::resize(usual, gray, size, 0, 0, cv::INTER_AREA);
  gray.convertTo(gray, CV_32F);
  cv::resize(images.depth, depth, size, 0, 0, cv::INTER_NEAREST);
  bool cut = false;
  if (!gray_.empty()) {
    const double alike = correlation(gray_, gray);
    const double changed = alike < kAlike ? measureDepthChange(depth_, depth) : 0.0;
    cut = changed < 0 ? alike < kAlikeAlone : changed > kChangedShare;
  }
  gray_ = gray;
  depth_ = depth;
  return cut;
}

}  // namespace hapticast::server
