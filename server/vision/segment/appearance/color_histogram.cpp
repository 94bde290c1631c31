// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/color_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::server {

namespace {

// Smooths by 1-2-1 along one colour channel, so that a small change of light is no new colour.
void smoothAlong(std::array<float, ColorHistogram::kBins>& bins, std::size_t stride) {
  for (std::size_t first = 0; first < bins.size(); ++first) {
    if (first / stride % 16 != 0) continue;
    float before = bins[first];
    for (std::size_t k = 0; k < 16; ++k) {
      float& here = bins[first + k * stride];
      const float after = k < 15 ? bins[first + (k + 1) * stride] : here;
      const float smooth = 0.25F * before + 0.5F * here + 0.25F * after;
      before = here;
      here = smooth;
    }
  }
}

}  // namespace

ColorHistogram ColorHistogram::fromImage(const cv::Mat& color, const cv::Mat& mask) {
  ColorHistogram out;
  for (int v = 0; v < mask.rows; ++v) {
    const auto* row = color.ptr<cv::Vec3b>(v);
    const auto* in = mask.ptr<unsigned char>(v);
    for (int u = 0; u < mask.cols; ++u) {
      if (in[u] != 0) out.count(row[u]);
    }
  }
  out.finish();
  return out;
}

void ColorHistogram::finish() {
  if (count_ == 0) return;
  for (float& fraction : fraction_) fraction /= static_cast<float>(count_);
  for (const std::size_t stride : {256U, 16U, 1U}) smoothAlong(fraction_, stride);
  empty_ = false;
}

void ColorHistogram::adapt(const ColorHistogram& other, double share) {
  if (other.empty_) return;
  const float keep = empty_ ? 0.0F : static_cast<float>(1.0 - share);
  for (std::size_t i = 0; i < kBins; ++i)
    fraction_[i] += (1.0F - keep) * (other.fraction_[i] - fraction_[i]);
  empty_ = false;
}

void ColorHistogram::raise(const ColorHistogram& other, double share, const ColorHistogram& own) {
  constexpr float kOwnShare = 0.25F;  // chosen
  if (other.empty_) return;
  for (std::size_t i = 0; i < kBins; ++i) {
    if (own.fraction_[i] > kOwnShare * other.fraction_[i]) continue;
    fraction_[i] = std::max(fraction_[i], static_cast<float>(share) * other.fraction_[i]);
  }
  empty_ = false;
}

double computeOverlap(const ColorHistogram& a, const ColorHistogram& b) {
  float sum = 0.0F;
  for (std::size_t i = 0; i < ColorHistogram::kBins; ++i) sum += std::sqrt(a[i] * b[i]);
  return static_cast<double>(sum);
}

std::vector<float> colorEvidence(const ColorHistogram& first, const ColorHistogram& now,
                                 const ColorHistogram& background) {
  std::vector<float> evidence(ColorHistogram::kBins);
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    const float object = 0.6F * first[i] + 0.4F * now[i] + 2e-5F;
    evidence[i] = std::clamp(std::log(object / (background[i] + 1.2e-4F)), -2.5F, 2.5F);
  }
  return evidence;
}

cv::Mat mapEvidence(const cv::Mat& color, const std::vector<float>& evidence) {
  cv::Mat out(color.size(), CV_32FC1);
  for (int v = 0; v < color.rows; ++v) {
    const auto* in = color.ptr<cv::Vec3b>(v);
    auto* to = out.ptr<float>(v);
    for (int u = 0; u < color.cols; ++u) to[u] = evidence[ColorHistogram::binIndex(in[u])];
  }
  return out;
}

}  // namespace hapticast::server
