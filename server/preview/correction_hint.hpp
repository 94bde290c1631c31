// SPDX-License-Identifier: MIT
// Hints for the author: finds a part of an object's mask that may not belong to the object, by
// simple heuristics. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

namespace hapticast::server {

/// A pixel inside a mask that may not belong to the object, with the reason.
struct CorrectionHint {
  cv::Point at_px;
  std::string why;  ///< reason, as the text that follows "--not U,V: "
};

/// Returns a place in `mask` that may not belong to the object, or nullopt if there is none. It
/// searches in this order: pixels at the picture's edge, pixels with colours of skin, pixels with
/// other colours than the rest of the mask. It never returns a place in the region of one of the
/// author's `clicks`, or near one. `color`: CV_8UC3. `mask`: CV_8UC1, 0/255, same size.
[[nodiscard]] std::optional<CorrectionHint> suggestCorrection(const cv::Mat& color,
                                                              const cv::Mat& mask,
                                                              const std::vector<cv::Point>& clicks);

}  // namespace hapticast::server
