// SPDX-License-Identifier: MIT
#include "server/vision/base/frame_images.hpp"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>

namespace hapticast::server {

namespace {

constexpr float kLargestDepth_mm = 1e5F;  // chosen: beyond the reach of depth cameras

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

}  // namespace hapticast::server
