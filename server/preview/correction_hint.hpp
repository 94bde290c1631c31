// SPDX-License-Identifier: MIT
// Heuristic hints for the author: finds a part of an object's mask that may not belong to it.
// Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

namespace hapticast::server {

/// A place inside the mask that may not belong to the object, with the reason.
struct CorrectionHint {
  cv::Point at_px;
  std::string why;  ///< text after "--not U,V: "
};

/// Searches for a suspicious part of `mask`, in this order: a contact with the picture's edge, skin
/// colours, a cluster of other colours. `color`: CV_8UC3. `mask`: CV_8UC1, 0/255, same size.
/// Returns nullopt if there is none.
[[nodiscard]] std::optional<CorrectionHint> suggestCorrection(const cv::Mat& color,
                                                              const cv::Mat& mask);

}  // namespace hapticast::server
