// SPDX-License-Identifier: MIT
// 16 x 16 x 16 colour histograms and the evidence they give for object or background.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Fractions per colour bin; sums to 1, or all 0 when nothing was seen.
class ColorHistogram {
 public:
  static constexpr std::size_t kBins = std::size_t{16} * 16 * 16;

  [[nodiscard]] static std::size_t binIndex(const cv::Vec3b& bgr) {
    return (std::size_t{bgr[0]} >> 4U) << 8U | (std::size_t{bgr[1]} >> 4U) << 4U |
           std::size_t{bgr[2]} >> 4U;
  }
  /// Of the pixels of `color` (CV_8UC3) where `mask` is not 0.
  static ColorHistogram fromImage(const cv::Mat& color, const cv::Mat& mask);

  /// Counts a pixel. Call settle() after the last one, before anything else.
  void count(const cv::Vec3b& bgr) {
    fraction_[binIndex(bgr)] += 1.0F;
    ++count_;
  }
  /// Counts become fractions, smoothed 1-2-1 along each channel.
  void finish();

  /// Moves towards `other` by `share`; takes it over when nothing was seen yet.
  void adapt(const ColorHistogram& other, double share);
  /// Takes, bin by bin, the larger fraction of the two, `share` of the other's; they sum to more
  /// than 1 then.
  void raise(const ColorHistogram& other, double share);
  [[nodiscard]] bool empty() const { return empty_; }
  [[nodiscard]] float operator[](std::size_t bin) const { return fraction_[bin]; }

 private:
  std::array<float, kBins> fraction_{};
  int count_ = 0;
  bool empty_ = true;
};

/// How alike two histograms are (Bhattacharyya): 0 nothing in common, 1 the same.
double computeOverlap(const ColorHistogram& a, const ColorHistogram& b);

/// Per bin log((0.6 first + 0.4 now + 2e-5) / (background + 1.2e-4)), cut to +-2.5. The larger
/// floor below makes a colour never seen background.
std::vector<float> colorEvidence(const ColorHistogram& first, const ColorHistogram& now,
                                 const ColorHistogram& background);

/// The evidence (by colour bin) of each pixel of `color` (CV_8UC3), CV_32FC1.
cv::Mat mapEvidence(const cv::Mat& color, const std::vector<float>& evidence);

}  // namespace hapticast::server
