// SPDX-License-Identifier: MIT
// Graph cut segmentation: Gaussian mixtures of colours in Lab and the minimum cut of a graph of
// pixels.
// Sources: Boykov and Jolly 2001; the mixtures are those of GrabCut (Rother, Kolmogorov and Blake
// 2004). Thread: the one that runs Vision.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Gaussian mixture of up to five parts over colours in Lab.
class ColorMixture {
 public:
  ColorMixture() = default;
  /// Fits the pixels of `lab` (CV_32FC3) where `where` is not 0. Empty if there are fewer than
  /// eight.
  ColorMixture(const cv::Mat& lab, const cv::Mat& where);
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  /// Returns the log density at `lab`, at least kLeast.
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

/// Returns the log densities of all pixels of `lab`, CV_32FC1.
cv::Mat logDensities(const ColorMixture& mixture, const cv::Mat& lab);

/// Returns the labelling of least energy (255: object). `unary`: CV_32FC1, above 0 for the object.
/// Cuts between neighbours of similar colour and depth cost most.
cv::Mat minimumCut(const cv::Mat& unary, const GraphRoi& view, const DepthNoise& noise);

}  // namespace hapticast::server
