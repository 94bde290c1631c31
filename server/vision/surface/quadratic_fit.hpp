// SPDX-License-Identifier: MIT
// Smooths an image inside a mask by local quadratic regression with Gaussian weights (a
// two-dimensional Savitzky-Golay filter). Such a fit does not flatten curved surfaces. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Returns `values` (CV_32FC1), smoothed inside `mask` (CV_8UC1, 0/255). Each result is the value
/// of a quadratic that was fitted to the values around its pixel. `sigma_px`: width of the weights.
/// The result is exact for planes and nearly exact for quadratics, up to the mask's edge.
cv::Mat fitQuadratic(const cv::Mat& values, const cv::Mat& mask, double sigma_px);

/// Replaces `height`, a fit to `rounded` with a narrow window, by a wider fit where possible, and
/// returns the result (Lepski's choice of a bandwidth). The wider fit has weights of the width
/// `sigma_px` and removes the terraces of `rounded`. The function uses it where it differs by at
/// most about `half_step` from all measured values around a pixel. Elsewhere no quadratic describes
/// the surface. `measured`: 0/255. To save time, the wider fit is computed for blocks of half a
/// `sigma_px`. Its difference to `height` is interpolated between the blocks. Blocks partly outside
/// `mask` retain `height`.
cv::Mat fitWider(const cv::Mat& height, const cv::Mat& rounded, const cv::Mat& mask,
                 const cv::Mat& measured, double half_step, double sigma_px);

/// Returns `values` (CV_32FC1), in which the pixels of `wanted` outside `known` are filled smoothly
/// from those of `known`. Returns an unchanged copy if no pixel is known or none is to be filled.
/// `known` and `wanted` are masks (CV_8UC1, 0/255). The method is push-pull inpainting (Gortler et
/// al. 1996), then membrane sweeps (Gauss-Seidel steps of Laplace's equation). With a `reduction`
/// above 1 most sweeps work at 1 / reduction of the size, and the last ones at full size. Thread:
/// any.
cv::Mat fillHoles(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted,
                  int reduction = 1);

/// Returns `values` at 1 / reduction of the size, with all pixels outside `known` filled by
/// push-pull only. That suffices for comparisons.
cv::Mat fillAtReducedSize(const cv::Mat& values, const cv::Mat& known, int reduction);

}  // namespace hapticast::server
