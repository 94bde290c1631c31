// SPDX-License-Identifier: MIT
// What an author may try next, from what the first frame shows of an object. Thread: any; values.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace hapticast::server {

/// A place inside `mask` that may not be the object's, and why one may think so.
struct CorrectionHint {
  cv::Point at_px;
  std::string why;  ///< completes "--not U,V: "
};

/// Looks, in this order, for what reaches the picture's edge, for the colours of skin, and for a
/// part of other colours than the rest. `color` CV_8UC3, `mask` 0 / 255 of the same size.
[[nodiscard]] std::optional<CorrectionHint> suggestCorrection(const cv::Mat& color,
                                                              const cv::Mat& mask);

}  // namespace hapticast::server
