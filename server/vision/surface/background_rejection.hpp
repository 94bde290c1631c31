// SPDX-License-Identifier: MIT
// Background rejection: finds the pixels inside a mask whose depth does not belong to the object.
// They are background, isolated pixels, or mixtures of object and background at the rim (flying
// pixels). Thread: any.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

/// Least width of the border around a mask in the depth image for foregroundPixels(), px.
inline constexpr int kGateReach_px = 15;

/// Returns a mask (CV_8UC1, 0/255) of those pixels of `known` that belong to the object. `known`:
/// the pixels inside `mask` whose depth was measured. Both are CV_8UC1, 0/255. `depth`: CV_32FC1,
/// mm; it must extend kGateReach_px beyond the mask. The function compares each depth at the rim
/// with the object's and with the background's depth, extrapolated to the rim at 1 / (`reduction` +
/// 1) of the size.
cv::Mat foregroundPixels(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                         const DepthNoise& noise, int reduction = 1);

/// Returns whether `mask` and the object's depth end at the same contour. It is true if nearly all
/// pixels at the rim of the mask continue the object's surface.
bool contoursAgree(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                   const DepthNoise& noise);

}  // namespace hapticast::server
