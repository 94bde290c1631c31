// SPDX-License-Identifier: MIT
// Hints for the author: finds the place where a negative point (--not) would most improve the score
// of an object's mask. It tries places from simple heuristics, and places that candidates for the
// first mask exclude. It computes the correction at each place, and compares the scores
// (objectness) before and after. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/vision/base/frame_pair.hpp"

namespace hapticast::server {

/// A pixel inside a mask that may not belong to the object, with the reason.
struct CorrectionHint {
  cv::Point at_px;
  std::string why;  ///< reason, as the text that follows "--not U,V: "
};

/// Returns the place in `mask` where a --not improves the score most, or nullopt if none improves
/// it clearly. It never returns a place in the region of one of the author's `clicks`, or near one.
/// `mask`: CV_8UC1, 0/255, size of `images`.
[[nodiscard]] std::optional<CorrectionHint> suggestCorrection(const FrameImages& images,
                                                              const cv::Mat& mask,
                                                              const std::vector<cv::Point>& clicks);

}  // namespace hapticast::server
