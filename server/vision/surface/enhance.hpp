// SPDX-License-Identifier: MIT
// From raw depth and a mask to a relief that can be touched: background depth rejected at the rim,
// holes filled from the object, one range for the clip, smoothing inside the mask only. README.md
// of server/vision compares the steps. Thread: any; values.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "common/haptic_frame.hpp"
#include "server/source/camera_model.hpp"
#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

/// The depth of one object's surface over the tight box of its mask. Its images are shared by
/// copies: nobody writes into them. They are no parts of larger ones, because OpenCV's filters look
/// beyond the borders of a part.
struct Surface {
  cv::Rect box;
  cv::Mat mask;   ///< CV_8UC1, 0 / 255
  cv::Mat depth;  ///< CV_32FC1, working depth; inside the mask every pixel has one, unless nothing
                  ///< was measured
  cv::Mat measured;         ///< CV_8UC1, 255 where `depth` is the sensor's own
  double quantum_mm = 0.0;  ///< > 0: rounded to this step and otherwise clean (8-bit depth)

  /// Whether there is no hole in it and nothing of it was dropped.
  [[nodiscard]] bool allMeasured() const {
    return cv::countNonZero(measured) == cv::countNonZero(mask);
  }
};

/// Drops what belongs to the background (two-sided gate at the 5 px rim, lonely pixels) and fills
/// the holes. `exact_mask`: the source's own; where depth ends at its contour, nothing is dropped.
/// The thesis's method keeps all measured depth and fills nothing (holes are 0). Linear in the box.
Surface cleanSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise,
                     Method method, bool exact_mask = false);

/// The depth as it was measured, nothing dropped or filled: enough where it is clean.
Surface rawSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise);

/// The last surface carried into `mask` (0 / 255, size of the picture) by the object's motion in
/// the picture: where this frame brings no depth of its own.
Surface warpSurface(const cv::Mat& mask, const Surface& before, const cv::Matx23d& similarity);

/// Whether enough of `mask` has depth to make a surface of.
bool hasDepth(const cv::Mat& depth, const cv::Mat& mask);

/// Heights 0..depth_mm: (far - z) / (far - near) x depth_mm, smoothed inside the mask by a local
/// quadratic fit with Gaussian weights (sigma 0.65 mm; for 8-bit depth up to 2.6 mm, as wide as the
/// fit stays within half a step of what was measured, which takes its terraces away); the thesis:
/// Gauss sigma 2 px over zero outside the mask.
std::shared_ptr<const Relief> makeRelief(const Surface& surface, const DepthRange& range,
                                         const Workspace& workspace, Method method,
                                         bool smooth = true);

}  // namespace hapticast::server
