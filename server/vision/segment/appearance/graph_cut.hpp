// SPDX-License-Identifier: MIT
// What belongs together by colour and depth: mixtures of Gaussians in Lab and the minimum cut of a
// graph of pixels (Boykov and Jolly 2001, the rounds of Rother, Kolmogorov and Blake 2004). Thread:
// the one that runs Vision.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/graph_roi.hpp"

namespace hapticast::server {

/// Up to five Gaussians over colours in Lab.
class ColorMixture {
 public:
  ColorMixture() = default;
  /// Of the pixels of `lab` (CV_32FC3) where `where` is not 0; empty where these are too few.
  ColorMixture(const cv::Mat& lab, const cv::Mat& where);
  [[nodiscard]] bool empty() const { return parts_.empty(); }
  /// Log of the density, not below kLeast.
  [[nodiscard]] float logDensity(const cv::Vec3f& lab) const;

  static constexpr float kLeast = -30.0F;

 private:
  struct Part {
    cv::Vec3f mean;
    cv::Matx33f inverse;
    float log_weight = 0.0F;  // with the determinant
  };
  std::vector<Part> parts_;
};

/// Logs of the densities of all pixels, CV_32FC1.
cv::Mat logDensities(const ColorMixture& mixture, const cv::Mat& lab);

/// The labelling (255 = object) of least energy: `unary` (CV_32FC1, above 0 speaks for the object),
/// and neighbours of like colour and depth rather stay together.
cv::Mat minimumCut(const cv::Mat& unary, const GraphRoi& view, const DepthNoise& noise);

}  // namespace hapticast::server
