// SPDX-License-Identifier: MIT
// Local quadratic regression with Gaussian weights inside a mask (a two-dimensional Savitzky-Golay
// filter), which smooths without flattening curvature. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Returns at each pixel of `mask` (CV_8UC1, 0/255) the value of the quadratic fitted to `values`
/// (CV_32FC1) around it. Exact for planes, nearly exact for quadratics, up to the rim. `sigma_px`:
/// width of the Gaussian weights.
cv::Mat quadraticFit(const cv::Mat& values, const cv::Mat& mask, double sigma_px);

/// Replaces `height`, a fit with a narrow window, by a fit with a wider window that removes the
/// terraces of `rounded` values. Lepski's choice of a bandwidth.
/// The wider fit applies where it stays within `half_step` of all `measured` (0/255) values around
/// a pixel. Elsewhere the surface is curved more than a quadratic.
/// The computation uses blocks of half a sigma. A block's mean has no more curvature bias than
/// `height`, and only the difference of the two fits is interpolated. Blocks partly outside `mask`
/// retain `height`.
cv::Mat widerFit(const cv::Mat& height, const cv::Mat& rounded, const cv::Mat& mask,
                 const cv::Mat& measured, double half_step, double sigma_px);

// Hole filling (inpainting): push-pull pyramid and membrane interpolation. Thread: any.

/// Fills the pixels of `wanted` outside `known` smoothly from `values` (CV_32FC1) at `known` (masks
/// CV_8UC1, 0/255). Returns a copy of `values` if nothing is known or nothing is to fill.
/// Push-pull inpainting (Gortler et al. 1996), then membrane sweeps (Gauss-Seidel steps of
/// Laplace's equation).
cv::Mat filled(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted);

/// Returns `values` at half size, filled everywhere from the pixels of `known` by push-pull only.
/// Sufficient for comparisons.
cv::Mat filledAtHalfSize(const cv::Mat& values, const cv::Mat& known);

}  // namespace hapticast::server
