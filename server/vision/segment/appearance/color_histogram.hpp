// SPDX-License-Identifier: MIT
// Colour histograms of 16 x 16 x 16 bins. Functions compare two histograms (Bhattacharyya), and
// compute the log likelihood ratio of object and background for each colour. Thread: any.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Colour histogram: the fraction of pixels in each colour bin. The sum of all fractions is 1, or 0
/// for an empty histogram.
class ColorHistogram {
 public:
  static constexpr std::size_t kBins = std::size_t{16} * 16 * 16;

  [[nodiscard]] static std::size_t binIndex(const cv::Vec3b& bgr) {
    return (std::size_t{bgr[0]} >> 4U) << 8U | (std::size_t{bgr[1]} >> 4U) << 4U |
           std::size_t{bgr[2]} >> 4U;
  }
  /// Returns the histogram of the pixels of `color` (CV_8UC3) where `mask` is not 0.
  static ColorHistogram fromImage(const cv::Mat& color, const cv::Mat& mask);

  /// Adds a pixel. Call finish() after the last pixel, before any other function.
  void count(const cv::Vec3b& bgr) {
    fraction_[binIndex(bgr)] += 1.0F;
    ++count_;
  }
  /// Converts the counts to fractions and smooths them with weights 1-2-1 along each colour
  /// channel.
  void finish();

  /// Moves each fraction towards that of `other`: `share` = 0 leaves it, `share` = 1 replaces it.
  /// An empty histogram becomes `other`.
  void adapt(const ColorHistogram& other, double share);
  /// Raises each fraction to at least `share` times the fraction in `other`. Exception: a colour
  /// whose fraction in `own` is more than a quarter of that in `other` is unchanged. The sum may
  /// then exceed 1.
  void raise(const ColorHistogram& other, double share, const ColorHistogram& own);
  [[nodiscard]] bool empty() const { return empty_; }
  [[nodiscard]] float operator[](std::size_t bin) const { return fraction_[bin]; }

 private:
  std::array<float, kBins> fraction_{};
  int count_ = 0;
  bool empty_ = true;
};

/// Returns the Bhattacharyya coefficient of two histograms, a measure of similarity: 0 if they have
/// no colour in common, 1 if they are equal.
double computeOverlap(const ColorHistogram& a, const ColorHistogram& b);

/// Returns the evidence of each colour bin: above 0 if the colour is the object's, below 0 if it is
/// the background's. The value is log((0.6 first + 0.4 now + 2e-5) / (background + 1.2e-4)),
/// clamped to -2.5..2.5. `first` and `now` are the object's colours at the start and at present. A
/// colour in none of the three histograms counts as background, because the constant of the
/// denominator is the larger one.
std::vector<float> colorEvidence(const ColorHistogram& first, const ColorHistogram& now,
                                 const ColorHistogram& background);

/// Returns an image (CV_32FC1) with the evidence of each pixel's colour. `color`: CV_8UC3.
/// `evidence`: result of colorEvidence().
cv::Mat mapEvidence(const cv::Mat& color, const std::vector<float>& evidence);

}  // namespace hapticast::server
