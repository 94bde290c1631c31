// SPDX-License-Identifier: MIT
// From raw depth and a mask to a relief that can be touched: background depth rejected at the rim,
// holes filled from the object, one range for the clip, smoothing inside the mask only
// (segmentation notes, section 4).
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "common/haptic_frame.hpp"
#include "server/vision/base/depth_scene.hpp"
#include "server/vision/base/view.hpp"

namespace hapticast::server {

/// The depth of one object's surface over the tight box of its mask.
struct Surface {
  cv::Rect box;
  cv::Mat mask;   ///< CV_8UC1, 0 / 255
  cv::Mat depth;  ///< CV_32FC1, working depth; inside the mask every pixel has one, unless nothing
                  ///< was measured
  cv::Mat measured;         ///< CV_8UC1, 255 where `depth` is the sensor's own
  double quantum_mm = 0.0;  ///< > 0: rounded to this step and otherwise clean (8-bit depth)
};

/// Drops what belongs to the background (two-sided gate at the 5 px rim, lonely pixels) and fills
/// the holes. The thesis's method keeps all measured depth and fills nothing (holes are 0). Linear
/// in the box.
Surface cleanSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise,
                     Method method);

/// The depth as it was measured, nothing dropped or filled: enough where it is clean.
Surface rawSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise);

/// Heights 0..depth_mm: (far - z) / (far - near) x depth_mm, smoothed inside the mask by a local
/// quadratic fit with Gaussian weights (sigma 0.65 mm; for 8-bit depth up to 2.6 mm, as wide as the
/// fit stays within half a step of what was measured, which takes its terraces away); the thesis:
/// Gauss sigma 2 px over zero outside the mask.
std::shared_ptr<const Relief> makeRelief(const Surface& surface, const DepthRange& range,
                                         const Workspace& workspace, Method method,
                                         bool smooth = true);

/// Values of `values` (CV_32FC1) where `known` (0 / 255), in the rest of `wanted` filled smoothly
/// from them: push-pull, then membrane sweeps. Nothing known or nothing to fill: as they are.
cv::Mat filled(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted);

/// Value at each pixel of `mask` of the quadratic fitted to `values` around it with Gaussian
/// weights inside the mask. Exact for planes, nearly so for quadratics up to the rim.
cv::Mat quadraticFit(const cv::Mat& values, const cv::Mat& mask, double sigma_px);
/// For values that are `rounded` to steps, of which `height` is a fit with a narrow window: a wider
/// one sees more of the terraces, and takes its place wherever it, too, stays within `half_step` of
/// all that was `measured` (0 / 255) around a pixel; elsewhere the surface bends more than a
/// quadratic (Lepski's choice of a bandwidth). Reckoned in blocks of half a sigma: the mean over
/// one is no more biased by curvature than that of `height`, and only the difference of the two is
/// interpolated. Blocks that are not all inside the mask keep `height`.
void widenFit(cv::Mat& height, const cv::Mat& rounded, const cv::Mat& mask, const cv::Mat& measured,
              double half_step, double sigma_px);

}  // namespace hapticast::server
