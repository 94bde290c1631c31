// SPDX-License-Identifier: MIT
// What the depth of a scene reads beside the truth: its noise over range, and the step of its
// values. Works on working depth (frame_images.hpp). Thread: any; values.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Depth noise per range, from second differences, and the step of the depth values.
struct DepthNoise {
  std::vector<double> sigma_mm;  ///< per kBin_mm of range; never empty after measureNoise()
  double quantum_mm = 0.0;
  bool eight_bit = false;  ///< the step is coarser than what a sensor's noise would be
  bool flickers = false;   ///< its scale and shift are found anew in each frame
  /// Of range; chosen: a sensor's noise grows with z², by a quarter over this at 1 m.
  static constexpr double kBin_mm = 250.0;

  [[nodiscard]] double at(double depth_mm) const;
  /// The largest step between neighbours on one surface: max(5 mm, 6 sigma, 1.5 quanta).
  [[nodiscard]] double step_mm(double depth_mm) const;
  /// Exact, or 8-bit and rounded but not noisy: nothing to be averaged out.
  [[nodiscard]] bool clean(double depth_mm) const;
};

/// Noise of white parts: 1.48 median |second difference| / sqrt(6), per range; the quantum is the
/// median gap between values that occur. Of noise that is correlated between pixels it reads 2 to 3
/// times less than there is.
DepthNoise measureNoise(const cv::Mat& depth);

}  // namespace hapticast::server
