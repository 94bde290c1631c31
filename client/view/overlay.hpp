// SPDX-License-Identifier: MIT
// Drawing of the film and of the screenshot: the video with the HIP's cone and the force arrow, and
// below it the force over time. Off screen.
// Thread: any (pure function).
#pragma once

#include <opencv2/core.hpp>

#include "client/view/force_plot.hpp"

namespace hapticast::client {

/// Draws `report` over `picture` (CV_8UC3 of the same play time; empty: a dark ground of the
/// workspace's size), and below it `history` with a mark at the time of `report`. Returns a new
/// picture, CV_8UC3, 960 px wide.
[[nodiscard]] cv::Mat drawOverlay(const cv::Mat& picture, const TickReport& report,
                                  const Workspace& workspace, const ForceHistory& history);

}  // namespace hapticast::client
