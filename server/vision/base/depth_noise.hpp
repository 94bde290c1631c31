// SPDX-License-Identifier: MIT
// Estimates the noise of a depth image: its standard deviation for each range of depths, and the
// step between its values (quantum). The estimate uses second differences of neighbouring pixels,
// because a smooth surface contributes almost nothing to them. Their median absolute value yields
// the standard deviation, because outliers hardly change a median. The input is the working depth
// of frame_pair.hpp, in mm. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Noise of a scene's depth: standard deviations at different depths, and the step between values.
struct DepthNoise {
  /// Standard deviation of depths in each interval of kBin_mm, mm. The first interval begins at 0
  /// mm. measureNoise() fills at least one entry.
  std::vector<double> sigma_mm;
  /// Smallest step between two depth values, mm; 0: values are continuous.
  double quantum_mm = 0.0;
  bool eight_bit = false;  ///< the depth has 8 bits: its steps are larger than a sensor's noise
  bool flickers = false;   ///< scale and shift of the depth differ from frame to frame
  /// Width of an interval of depths, mm. The value is a choice: a sensor's noise grows with the
  /// square of the depth. Around 1 m it grows by a quarter over 125 mm, which is half of this
  /// width.
  static constexpr double kBin_mm = 250.0;

  /// Returns the standard deviation of a measured depth at `depth_mm`, mm. Requires a non-empty
  /// sigma_mm.
  [[nodiscard]] double at(double depth_mm) const;
  /// Returns the largest difference of depth that neighbouring pixels of one surface can have, mm.
  /// It is the largest of 5 mm, 6 standard deviations and 1.5 quanta.
  [[nodiscard]] double step_mm(double depth_mm) const;
  /// Returns whether smoothing cannot improve the depth at `depth_mm`. That is so for depth without
  /// noise, and for 8-bit depth whose only error is rounding.
  [[nodiscard]] bool clean(double depth_mm) const;
};

/// Measures the noise of `depth` (CV_32FC1, mm, 0: not measured). The standard deviation of each
/// interval is 1.48 times the median |second difference|, divided by sqrt(6). This formula assumes
/// that the errors of neighbouring pixels are independent. If they are correlated, the result is
/// only a half to a third of the true value. The quantum is the median gap between the depth values
/// in the image.
DepthNoise measureNoise(const cv::Mat& depth);

}  // namespace hapticast::server
