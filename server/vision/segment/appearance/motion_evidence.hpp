// SPDX-License-Identifier: MIT
// Motion segmentation with two motions (layers, Wang and Adelson 1994): the object moves by one
// similarity, and its surroundings (for example an arm) move by another one. A pixel belongs to the
// motion that explains it better: with this motion, the warped last picture resembles this picture
// more at the pixel. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "server/vision/base/flow.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// The motion of an object's surroundings since the last picture, and that picture.
struct OtherMotion {
  cv::Mat last_gray;       ///< CV_8UC1
  cv::Matx23d similarity;  ///< px of the last picture to px of this picture
};

/// Returns the main motion of the ring around `mask` from the last picture to this picture, or
/// nullopt if the ring has too few corners, or if it moves with the object. `mask` (0/255) and
/// `flow`: the object in the last picture, and its motion. Both pictures are CV_8UC1 of one size.
std::optional<OtherMotion> findOtherMotion(const cv::Mat& last_gray, const cv::Mat& gray,
                                           const cv::Mat& mask, const ObjectFlow& flow);

/// Returns for each pixel of the patch how much better the object's motion `own` explains it than
/// the other motion: CV_32FC1, -1..1, above 0 for the object; 0 where both motions are the same.
cv::Mat computeMotionEvidence(const ObjectRoi& patch, const OtherMotion& other,
                              const cv::Matx23d& own);

}  // namespace hapticast::server
