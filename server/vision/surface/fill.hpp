// SPDX-License-Identifier: MIT
// Holes in images are filled from what is known around them. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Values of `values` (CV_32FC1) where `known` (0 / 255), in the rest of `wanted` filled smoothly
/// from them: push-pull inpainting (Gortler et al. 1996), then membrane sweeps (Gauss-Seidel steps
/// of Laplace's equation). Nothing known or nothing to fill: as they are.
cv::Mat filled(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted);

/// `values` where `known`, halved, and filled everywhere by push-pull: enough where they are only
/// compared with.
cv::Mat filledAtHalfSize(const cv::Mat& values, const cv::Mat& known);

}  // namespace hapticast::server
