// SPDX-License-Identifier: MIT
// Surface reconstruction: converts the depth inside an object's mask to a relief. It rejects depth
// of the background at the rim of the mask and fills holes with depth of the object. One mapped
// range for the whole clip converts depths to heights, which are then smoothed inside the mask.
// README.md of server/vision compares methods for these steps. Thread: any.
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
  /// Depth, CV_32FC1, mm; larger is farther. Inside the mask it has no holes after cleanSurface(),
  /// unless nothing was measured.
  cv::Mat depth;
  cv::Mat measured;  ///< CV_8UC1, 255 where `depth` was measured, 0 where it was filled
  /// Step between the values of 8-bit depth without other noise, mm; else 0.
  double quantum_mm = 0.0;
  /// Factor by which algorithms with a smooth result may downsample this surface; 1: full size.
  int reduction = 1;

  /// Returns whether every pixel of the mask was measured and none was rejected.
  [[nodiscard]] bool isMeasuredEverywhere() const {
    return cv::countNonZero(measured) == cv::countNonZero(mask);
  }
};

/// Largest number of pixels of a surface that all algorithms process at full size. In pictures of
/// the usual width (reduction.hpp) they process every surface at full size. Chosen for time: 300 x
/// 300.
inline constexpr double kLargestSurface_px = 90e3;

/// Returns the surface of `mask`: rejects background at the rim (5 px wide) and isolated pixels,
/// and fills the holes. `exact_mask`: whether the mask is the source's own. If it is, and the depth
/// ends at the mask's contour, nothing is rejected. The thesis's method uses all measured depth and
/// fills nothing (holes are 0). The time is linear in the number of pixels of the box.
Surface cleanSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise,
                     Method method, bool exact_mask = false);

/// Returns the surface of `mask` with the measured depth, without rejection or filling. That
/// suffices for clean depth.
Surface rawSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise);

/// Returns the surface of `mask` (CV_8UC1, 0/255, size of the image), made from the last surface
/// `before`. `similarity` moves `before` from the last picture to this picture. Use it for frames
/// without new depth of the object.
Surface warpSurface(const cv::Mat& mask, const Surface& before, const cv::Matx23d& similarity);

/// Returns whether the depth was measured in at least 2 % of `mask`, which is enough for a surface.
bool hasDepth(const cv::Mat& depth, const cv::Mat& mask);

/// Returns the relief of `surface`. Its heights are (far - z) / (far - near) x depth_mm of the
/// workspace, clamped to 0..depth_mm. `range` is the mapped range. If `smooth` is true, a local
/// quadratic fit with Gaussian weights (sigma 0.65 mm) smooths the heights inside the mask. For
/// 8-bit depth a wider sigma of up to 2.6 mm removes terraces. The wider sigma applies only where
/// its fit differs from the measured heights by at most half a step of the 8-bit depth. The
/// thesis's method smooths by a Gaussian (sigma 2 px), with height 0 outside the mask.
std::shared_ptr<const Relief> makeRelief(const Surface& surface, const DepthRange& range,
                                         const Workspace& workspace, Method method,
                                         bool smooth = true);

}  // namespace hapticast::server
