// SPDX-License-Identifier: MIT
// Colour histograms of 16 x 16 x 16 bins, their Bhattacharyya similarity, and the log likelihood
// ratio of object against background. Thread: any.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Fraction of pixels for each colour bin. The sum is 1, or 0 for an empty histogram.
class ColorHistogram {
 public:
  static constexpr std::size_t kBins = std::size_t{16} * 16 * 16;

  [[nodiscard]] static std::size_t binIndex(const cv::Vec3b& bgr) {
    return (std::size_t{bgr[0]} >> 4U) << 8U | (std::size_t{bgr[1]} >> 4U) << 4U |
           std::size_t{bgr[2]} >> 4U;
  }
  /// Returns the histogram of the pixels of `color` (CV_8UC3) where `mask` is not 0.
  static ColorHistogram fromImage(const cv::Mat& color, const cv::Mat& mask);

  /// Counts a pixel. Call finish() after the last pixel, before any other function.
  void count(const cv::Vec3b& bgr) {
    fraction_[binIndex(bgr)] += 1.0F;
    ++count_;
  }
  /// Converts counts to fractions, smoothed by 1-2-1 along each channel.
  void finish();

  /// Moves the fractions towards `other` by `share` (0..1). An empty histogram becomes `other`.
  void adapt(const ColorHistogram& other, double share);
  /// Raises each bin to at least `share` of the bin of `other`. The sum may then exceed 1.
  void raise(const ColorHistogram& other, double share);
  [[nodiscard]] bool empty() const { return empty_; }
  [[nodiscard]] float operator[](std::size_t bin) const { return fraction_[bin]; }

 private:
  std::array<float, kBins> fraction_{};
  int count_ = 0;
  bool empty_ = true;
};

/// Returns the Bhattacharyya coefficient of two histograms: 0 disjoint, 1 equal.
double computeOverlap(const ColorHistogram& a, const ColorHistogram& b);

/// Returns for each bin log((0.6 first + 0.4 now + 2e-5) / (background + 1.2e-4)), clamped to
/// +-2.5. The larger floor in the denominator makes an unseen colour background.
std::vector<float> colorEvidence(const ColorHistogram& first, const ColorHistogram& now,
                                 const ColorHistogram& background);

/// Returns the evidence of each pixel's colour bin, CV_32FC1. `color`: CV_8UC3.
cv::Mat mapEvidence(const cv::Mat& color, const std::vector<float>& evidence);

}  // namespace hapticast::server
