// SPDX-License-Identifier: MIT
// Registers the depth of a Kinect to its colour by forward warping with a z-buffer: computes for
// each pixel of the colour picture the depth of the point that it shows. Thread: one.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/source/scale/kinect_calibration.hpp"

namespace hapticast::server {

/// Registration for one clip.
class DepthRegistration {
 public:
  /// Prepares tables for pictures of the sizes of both cameras.
  DepthRegistration(const LensCamera& depth, const LensCamera& color,
                    const KinectCalibration& calibration);

  /// Returns the size of the registered depth: that of the colour, divided so that it has about the
  /// resolution of the depth. It has the aspect ratio of the colour.
  [[nodiscard]] cv::Size size() const { return size_; }

  /// Converts `depth` (CV_16UC1, mm) from the depth camera's view to the colour camera's, and
  /// returns it: CV_16UC1, mm along the colour camera's axis, of size(). Where several points fall
  /// on a pixel, the nearest one counts. 0: not measured, or hidden from the depth camera.
  [[nodiscard]] cv::Mat run(const cv::Mat& depth) const;

 private:
  /// Writes the depth of a point to all pixels of `out` that its depth pixel covers. `at_mm`: the
  /// point in the colour camera's frame. `half_mm`: half the width of the depth pixel there.
  void splatDepth(const cv::Vec3d& at_mm, double half_mm, cv::Mat& out) const;

  LensCamera color_;
  cv::Size depth_size_;
  cv::Size size_;
  double radius_ = 0.0;          // of the farthest points at Z = 1 that the colour camera sees
  std::vector<cv::Vec3f> rays_;  // of the pixels of the depth at 1 mm, in the colour camera's axes
  std::vector<float> half_widths_;  // of the pixels of the depth at 1 mm, mm
  cv::Vec3d translation_mm_;
};

}  // namespace hapticast::server
