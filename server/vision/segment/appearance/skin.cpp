// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/skin.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr int kLight_px = 320;  // width of the picture that measures the light
constexpr int kLevels = 32;     // for each colour channel
// Chosen, L of 100: the colours of darker skin are tested as if skin had this brightness. Below the
// second one noise has any hue.
constexpr float kDark = 35.0F;
constexpr float kDarkest = 9.0F;

std::size_t skinBin(const cv::Vec3b& bgr) {
  return (std::size_t{bgr[0]} >> 3U) << 10U | (std::size_t{bgr[1]} >> 3U) << 5U |
         std::size_t{bgr[2]} >> 3U;
}

cv::Mat toLab(const cv::Mat& color) {
  cv::Mat out;
  color.convertTo(out, CV_32F, 1.0 / 255.0);
  cv::cvtColor(out, out, cv::COLOR_BGR2Lab);
  return out;
}

// Returns the colour cast (a, b per L): the median of nearly grey pixels that are brighter than
// most. Chosen: a fifth of the picture, so that one pink sheet of paper does not count as white.
cv::Vec2f computeColorCast(const cv::Mat& lab) {
  std::vector<cv::Vec3f> grey;
  grey.reserve(lab.total());
  for (int v = 0; v < lab.rows; ++v) {
    for (int u = 0; u < lab.cols; ++u) {
      const auto& at = lab.at<cv::Vec3f>(v, u);
      if (std::hypot(at[1], at[2]) < 25.0F && at[0] < 99.0F) grey.push_back(at);
    }
  }
  const std::size_t few = std::min(grey.size(), lab.total() / 5);
  if (few < 40) return {0.0F, 0.0F};
  const auto brightest = grey.end() - static_cast<std::ptrdiff_t>(few);
  std::nth_element(grey.begin(), brightest, grey.end(),
                   [](const cv::Vec3f& a, const cv::Vec3f& b) { return a[0] < b[0]; });
  const auto cast = [&](int channel) {
    std::vector<double> values;
    values.reserve(few);
    for (auto it = brightest; it != grey.end(); ++it)
      values.push_back(double((*it)[channel] / std::max((*it)[0], 1.0F)));
    return static_cast<float>(computeMedian(values));
  };
  return {cast(1), cast(2)};
}

// Chosen from light and dark skin in warm and cold light: hues from red to yellow, medium chroma.
bool isSkin(const cv::Vec3f& lab, const cv::Vec2f& cast) {
  const float a = lab[1] - cast[0] * lab[0];
  const float b = lab[2] - cast[1] * lab[0];
  const float chroma = std::hypot(a, b);
  const float hue_deg = std::atan2(b, a) * 57.29578F;
  return lab[0] > 18.0F && a > 7.0F && a < 32.0F && hue_deg > 8.0F && hue_deg < 68.0F &&
         chroma > 11.0F && chroma < 46.0F;
}

// Less light reduces L, a and b in proportion.
bool isDarkSkin(const cv::Vec3f& lab, const cv::Vec2f& cast) {
  return lab[0] > kDarkest && lab[0] < kDark && isSkin((kDark / lab[0]) * lab, cast);
}

}  // namespace

SkinColors SkinColors::adaptToLight(const cv::Mat& color) {
  cv::Mat small;
  const double shrink = std::min(1.0, double(kLight_px) / color.cols);
  cv::resize(color, small, {}, shrink, shrink, cv::INTER_AREA);
  const cv::Vec2f cast = computeColorCast(toLab(small));
  cv::Mat all(kLevels * kLevels, kLevels, CV_8UC3);
  for (int i = 0; i < all.rows; ++i) {
    for (int k = 0; k < all.cols; ++k) {
      const auto level = [](int n) { return static_cast<unsigned char>(8 * n + 4); };
      all.at<cv::Vec3b>(i, k) = {level(i / kLevels), level(i % kLevels), level(k)};
    }
  }
  const cv::Mat lab = toLab(all);
  SkinColors out;
  out.kinds_.resize(all.total());
  for (int i = 0; i < all.rows; ++i) {
    for (int k = 0; k < all.cols; ++k) {
      const auto& at = lab.at<cv::Vec3f>(i, k);
      out.kinds_[skinBin(all.at<cv::Vec3b>(i, k))] = isSkin(at, cast)       ? kSkin
                                                     : isDarkSkin(at, cast) ? kDarkSkin
                                                                            : kNone;
    }
  }
  return out;
}

cv::Mat SkinColors::find(const cv::Mat& color, Kind least) const {
  if (empty() || color.cols < 4 || color.rows < 4) return cv::Mat::zeros(color.size(), CV_8UC1);
  cv::Mat half;
  cv::resize(color, half, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::Mat skin(half.size(), CV_8UC1);
  for (int v = 0; v < half.rows; ++v) {
    const auto* from = half.ptr<cv::Vec3b>(v);
    auto* to = skin.ptr<unsigned char>(v);
    for (int u = 0; u < half.cols; ++u) to[u] = kinds_[skinBin(from[u])] >= least ? 255 : 0;
  }
  cv::medianBlur(skin, skin, 3);
  const cv::Mat finger = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  cv::morphologyEx(skin, skin, cv::MORPH_OPEN, finger);
  cv::resize(skin, skin, color.size(), 0, 0, cv::INTER_NEAREST);
  return skin;
}

}  // namespace hapticast::server
