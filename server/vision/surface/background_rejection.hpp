// SPDX-License-Identifier: MIT
// Which measured depth inside a mask is the object's, and which the background's. Thread: any;
// values.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

inline constexpr int kGateReach_px = 15;  ///< so far around a mask is looked

/// Of the pixels `known` (measured, inside `mask`): those that are the object's. `depth` is working
/// depth and reaches kGateReach_px beyond the mask.
cv::Mat foregroundPixels(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                         const DepthNoise& noise);

/// Whether mask and depth end at the same contour: hardly a pixel of the rim is not the surface
/// carried on.
bool contoursAgree(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                   const DepthNoise& noise);

}  // namespace hapticast::server
