// SPDX-License-Identifier: MIT
// Background rejection: separates the object's depth pixels inside a mask from background, mixed
// (flying) and isolated pixels. Thread: any.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

inline constexpr int kGateReach_px = 15;  ///< required depth around a mask

/// Returns those pixels of `known` that belong to the object. `known`: measured pixels inside
/// `mask` (all CV_8UC1, 0/255).
/// `depth`: working depth (CV_32FC1, mm), which extends kGateReach_px beyond the mask.
cv::Mat foregroundPixels(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                         const DepthNoise& noise);

/// Returns whether mask and depth end at the same contour: nearly all rim pixels continue the
/// surface.
bool contoursAgree(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                   const DepthNoise& noise);

}  // namespace hapticast::server
