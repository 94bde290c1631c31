// SPDX-License-Identifier: MIT
// Hole filling (inpainting): push-pull pyramid and membrane interpolation. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Fills the pixels of `wanted` outside `known` smoothly from `values` (CV_32FC1) at `known` (masks
/// CV_8UC1, 0/255). Returns a copy of `values` if nothing is known or nothing is to fill.
/// Push-pull inpainting (Gortler et al. 1996), then membrane sweeps (Gauss-Seidel steps of
/// Laplace's equation).
cv::Mat filled(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted);

/// Returns `values` at half size, filled everywhere from the pixels of `known` by push-pull only.
/// Sufficient for comparisons.
cv::Mat filledAtHalfSize(const cv::Mat& values, const cv::Mat& known);

}  // namespace hapticast::server
