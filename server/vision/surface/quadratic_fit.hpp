// SPDX-License-Identifier: MIT
// Smoothing inside a mask without flattening what bends: local quadratic fits with Gaussian
// weights. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Value at each pixel of `mask` (0 / 255) of the quadratic fitted to `values` (CV_32FC1) around it
/// with Gaussian weights inside the mask. Exact for planes, nearly so for quadratics up to the rim.
cv::Mat quadraticFit(const cv::Mat& values, const cv::Mat& mask, double sigma_px);

/// For values that are `rounded` to steps, of which `height` is a fit with a narrow window: a wider
/// one sees more of the terraces, and takes its place wherever it, too, stays within `half_step` of
/// all that was `measured` (0 / 255) around a pixel; elsewhere the surface bends more than a
/// quadratic (Lepski's choice of a bandwidth). Reckoned in blocks of half a sigma: the mean over
/// one is no more biased by curvature than that of `height`, and only the difference of the two is
/// interpolated. Blocks that are not all inside the mask keep `height`.
cv::Mat widerFit(const cv::Mat& height, const cv::Mat& rounded, const cv::Mat& mask,
                 const cv::Mat& measured, double half_step, double sigma_px);

}  // namespace hapticast::server
