// SPDX-License-Identifier: MIT
#include "server/source/picture/depth_code.hpp"

#include <algorithm>

#include "server/source/picture/image_file.hpp"

namespace hapticast::server {

namespace {

constexpr float kHueRange_mm = 3000.0F;  // Record3D
constexpr float kNearestHue_mm = 100.0F;
constexpr float kFarthestHue_mm = 2800.0F;
// Chosen: pure hues have 255. The mixture of two hues, or of a hue and black, has less.
constexpr int kClearHue = 128;
constexpr int kPureHue = 210;  // chosen: coded depth after a lossy codec

/// Returns the difference of the largest and the smallest channel.
int computeChroma(const cv::Vec3b& bgr) {
  const auto [least, most] = std::minmax({bgr[0], bgr[1], bgr[2]});
  return int{most} - int{least};
}

/// Returns the depth of one pixel in mm; 0: none.
float hueDepth_mm(const cv::Vec3b& bgr) {
  const int chroma = computeChroma(bgr);
  if (chroma < kClearHue) return 0.0F;
  const int b = bgr[0];
  const int g = bgr[1];
  const int r = bgr[2];
  const int most = std::max({r, g, b});
  const auto scale = static_cast<float>(chroma);
  float sixths = 0.0F;
  if (most == r) {
    sixths = static_cast<float>(g - b) / scale + (g < b ? 6.0F : 0.0F);
  } else if (most == g) {
    sixths = static_cast<float>(b - r) / scale + 2.0F;
  } else {
    sixths = static_cast<float>(r - g) / scale + 4.0F;
  }
  const float depth_mm = kHueRange_mm * sixths / 6.0F;
  return depth_mm >= kNearestHue_mm && depth_mm < kFarthestHue_mm ? depth_mm : 0.0F;
}

/// Returns the share of pixels whose hue is as pure as that of coded depth.
double pureHueShare(const cv::Mat& picture) {
  std::size_t clear = 0;
  for (int v = 0; v < picture.rows; ++v) {
    const auto* const row = picture.ptr<cv::Vec3b>(v);
    clear +=
        static_cast<std::size_t>(std::count_if(row, row + picture.cols, [](const cv::Vec3b& pixel) {
          return computeChroma(pixel) >= kPureHue;
        }));
  }
  return static_cast<double>(clear) /
         static_cast<double>(std::max<std::size_t>(picture.total(), 1));
}

}  // namespace

PictureHalves splitPicture(const cv::Mat& picture, const VideoLayout& layout) {
  const bool beside = layout.layout == Layout::kSideBySide;
  const int width_px = beside ? picture.cols / 2 : picture.cols;
  const int height_px = beside ? picture.rows : picture.rows / 2;
  const cv::Mat first = picture(cv::Rect(0, 0, width_px, height_px));
  const cv::Mat second =
      picture(cv::Rect(picture.cols - width_px, picture.rows - height_px, width_px, height_px));
  return layout.code == DepthCode::kHue ? PictureHalves{second, first}
                                        : PictureHalves{first, second};
}

cv::Mat decodeDepth(const cv::Mat& raw, DepthCode code) {
  if (code == DepthCode::kGrey || raw.empty() || raw.depth() != CV_8U) return raw;
  cv::Mat depth;
  if (code == DepthCode::kInverse) {
    cv::bitwise_not(raw, depth);
    return depth;
  }
  if (raw.type() != CV_8UC3) return raw;
  depth.create(raw.size(), CV_32FC1);
  for (int v = 0; v < raw.rows; ++v) {
    const auto* const row = raw.ptr<cv::Vec3b>(v);
    std::transform(row, row + raw.cols, depth.ptr<float>(v), hueDepth_mm);
  }
  return depth;
}

std::string guessLayout(const cv::Mat& picture) {
  constexpr double kHueHalf = 0.3;   // chosen: a room of which a third is within 2.8 m
  constexpr double kOrdinary = 0.5;  // chosen: colour has at most half as many pure hues
  if (picture.type() != CV_8UC3 || picture.cols < 2 || picture.rows < 2) return "";
  for (const Layout layout : {Layout::kSideBySide, Layout::kTopBottom}) {
    const bool beside = layout == Layout::kSideBySide;
    const char* const flag = beside ? "--layout side-by-side" : "--layout top-bottom";
    const char* const kind = beside ? "side by side" : "one above the other";
    const auto [first, second] = splitPicture(picture, {layout, DepthCode::kGrey});
    const double hues = pureHueShare(first);
    std::string guess = "looks like ";
    guess += kind;
    if (hues >= kHueHalf && pureHueShare(second) < kOrdinary * hues) {
      guess += " with hue-coded depth ";
      guess += beside ? "on the left" : "at the top";
      guess += "; confirm with ";
      guess += flag;
      return guess.append(" --depth-code hue");
    }
    if (isColorCoded(first) && !isColorCoded(second)) {
      guess += " with grey depth ";
      guess += beside ? "on the right" : "below";
      guess += "; confirm with ";
      guess += flag;
      return guess.append(" (--depth-near dark if near is dark)");
    }
  }
  return "";
}

}  // namespace hapticast::server
