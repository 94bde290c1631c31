// SPDX-License-Identifier: MIT
// Noise estimation of a depth image: standard deviation over range, from the median of absolute
// second differences (median absolute deviation), and the quantum of the depth values.
// The input is working depth (frame_pair.hpp). Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Depth noise for each bin of range, and the quantum of the depth values.
struct DepthNoise {
  /// Standard deviation for each kBin_mm of range; not empty after measureNoise().
  std::vector<double> sigma_mm;
  double quantum_mm = 0.0;  ///< step between depth values, 0 or more; 0: continuous
  bool eight_bit = false;   ///< 8-bit depth: its quantum is coarser than a sensor's noise
  bool flickers = false;    ///< the source estimates scale and shift anew for each frame
  /// Width of a bin of range. Chosen: a sensor's noise grows with z², by a quarter over this width
  /// at 1 m.
  static constexpr double kBin_mm = 250.0;

  /// Returns the standard deviation at `depth_mm`, mm. Requires a non-empty sigma_mm.
  [[nodiscard]] double at(double depth_mm) const;
  /// Returns the largest step between neighbours on one surface: max(5 mm, 6 sigma, 1.5 quanta).
  [[nodiscard]] double step_mm(double depth_mm) const;
  /// Returns whether averaging would not improve this depth: exact, or 8-bit with rounding as its
  /// only error.
  [[nodiscard]] bool clean(double depth_mm) const;
};

/// Measures the noise of `depth` (CV_32FC1, mm, 0: not measured). The noise of each bin is 1.48
/// median |second difference| / sqrt(6), which assumes uncorrelated pixels.
/// Correlated noise yields 2 to 3 times less than its true value. The quantum is the median gap
/// between the values that occur.
DepthNoise measureNoise(const cv::Mat& depth);

}  // namespace hapticast::server
