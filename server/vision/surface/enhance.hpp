// SPDX-License-Identifier: MIT
// Surface reconstruction: from raw depth and a mask to a relief. Rejects background depth at the
// rim, fills holes from the object, maps one range for the whole clip, smooths inside the mask.
// README.md of server/vision compares the steps. Thread: any.
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "common/haptic_frame.hpp"
#include "server/source/camera_model.hpp"
#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

/// Depth of one object's surface over the bounding box of its mask. Copies share the images, which
/// are read-only. The images are not parts of larger ones, because OpenCV's filters read beyond the
/// borders of a part.
struct Surface {
  cv::Rect box;  ///< px of the picture
  cv::Mat mask;  ///< CV_8UC1, 0/255
  /// CV_32FC1, working depth, mm; inside the mask without holes unless nothing was measured.
  cv::Mat depth;
  cv::Mat measured;         ///< CV_8UC1, 255: `depth` is the sensor's own
  double quantum_mm = 0.0;  ///< > 0: step of rounded, otherwise clean depth (8-bit), mm

  /// Returns whether every pixel of the mask was measured and none was rejected.
  [[nodiscard]] bool allMeasured() const {
    return cv::countNonZero(measured) == cv::countNonZero(mask);
  }
};

/// Rejects background pixels (two-sided gate at the 5 px rim, isolated pixels) and fills the holes.
/// `exact_mask`: the source's own mask; if depth ends at its contour, nothing is rejected.
/// The thesis's method uses all measured depth and fills nothing (holes are 0). Time is linear in
/// the box.
Surface cleanSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise,
                     Method method, bool exact_mask = false);

/// Returns the measured depth without rejection or filling: sufficient for clean depth.
Surface rawSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise);

/// Warps the last surface into `mask` (CV_8UC1, 0/255, image size) by the object's motion in the
/// picture. For frames without new depth of the object.
Surface warpSurface(const cv::Mat& mask, const Surface& before, const cv::Matx23d& similarity);

/// Returns whether at least 2 % of `mask` have depth, enough for a surface.
bool hasDepth(const cv::Mat& depth, const cv::Mat& mask);

/// Returns the relief: heights (far - z) / (far - near) x depth_mm, clamped to 0..depth_mm.
/// `smooth`: a local quadratic fit with Gaussian weights inside the mask (sigma 0.65 mm). For 8-bit
/// depth sigma is up to 2.6 mm where the fit stays within half a step of the measurement; this
/// removes terraces.
/// The thesis's method smooths by a Gaussian (sigma 2 px), with zero outside the mask.
std::shared_ptr<const Relief> makeRelief(const Surface& surface, const DepthRange& range,
                                         const Workspace& workspace, Method method,
                                         bool smooth = true);

}  // namespace hapticast::server
