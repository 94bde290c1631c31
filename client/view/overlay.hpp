// SPDX-License-Identifier: MIT
// Drawing of the screenshot. It shows the video with the HIP as a cone and the
// force as an arrow. Below it is the force over time. The drawing needs no display.
// Thread: any (pure function).
#pragma once

#include <opencv2/core.hpp>

#include "client/view/force_plot.hpp"

namespace hapticast::client {

/// Returns a new picture, CV_8UC3, 960 px wide. Its upper part is `picture` with the HIP and the
/// force of `report`. Its lower part is the plot of `history` with a mark at the time of `report`.
/// `picture` is CV_8UC3 and belongs to the play time of `report`. If it is empty, the upper part is
/// a dark ground of the workspace's size.
[[nodiscard]] cv::Mat drawOverlay(const cv::Mat& picture, const TickReport& report,
                                  const Workspace& workspace, const ForceHistory& history);

}  // namespace hapticast::client
