// SPDX-License-Identifier: MIT
// Registers the depth of a Kinect to its colour: finds for each pixel of the colour the depth of
// the point that it shows. Thread: one.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/source/picture/kinect_calibration.hpp"

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

  /// Returns `depth` (CV_16UC1, mm, of the depth camera) as the colour camera sees it: CV_16UC1, mm
  /// along its axis, of size(). The nearest surface hides others. 0: not measured, or hidden from
  /// the depth camera.
  [[nodiscard]] cv::Mat run(const cv::Mat& depth) const;

 private:
  /// Writes a point of the colour camera's axes to the pixels that the pixel of the depth covers.
  /// `half_mm`: half its width.
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
