// SPDX-License-Identifier: MIT
// Draws what a viewer sees: the video with the HIP's cone and the force arrow, and below it the
// force over time. Off screen; a screenshot and a window show the same. Thread: any.
#pragma once

#include <opencv2/core.hpp>

#include "client/view/force_history.hpp"

namespace hapticast::client {

/// Draws `report` over `picture` (CV_8UC3 of the same play time; empty: a dark ground of the
/// workspace's size), and under it all of `history` with a mark at the moment of `report`.
/// Returns a picture of its own, CV_8UC3, 960 px wide.
[[nodiscard]] cv::Mat drawOverlay(const cv::Mat& picture, const TickReport& report,
                                  const Workspace& workspace, const ForceHistory& history);

}  // namespace hapticast::client
