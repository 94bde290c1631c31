// SPDX-License-Identifier: MIT
// Mixtures of Gaussians of colours in Lab, those of GrabCut (Rother, Kolmogorov and Blake 2004).
// Thread: the one that runs Vision.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Returns `color` (CV_8UC3, BGR) in Lab: CV_32FC3, L 0..100.
cv::Mat toLab(const cv::Mat& color);

/// Distribution of colours in Lab, as a mixture of up to five Gaussians.
class ColorMixture {
 public:
  ColorMixture() = default;
  /// Fits the mixture to the pixels of `lab` (CV_32FC3) where `where` is not 0. The mixture is
  /// empty if there are fewer than eight such pixels.
  ColorMixture(const cv::Mat& lab, const cv::Mat& where);
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  /// Returns the logarithm of the density at the colour `lab`, but at least kLeast.
  [[nodiscard]] float logDensity(const cv::Vec3f& lab) const;

  static constexpr float kLeast = -30.0F;

 private:
  struct Part {
    cv::Vec3f mean;
    cv::Matx33f inverse;
    float log_weight = 0.0F;  // includes the determinant
  };
  std::vector<Part> parts_;
};

/// Returns the logarithms of the densities at all pixels of `lab` (CV_32FC3), as CV_32FC1.
cv::Mat logDensities(const ColorMixture& mixture, const cv::Mat& lab);

}  // namespace hapticast::server
