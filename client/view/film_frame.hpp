// SPDX-License-Identifier: MIT
// Drawing of one frame of the film, 1280 x 720 px: the video with the HIP and the forces, a
// caption, a legend, and the force of the last seconds with fixed axes. Thread: any (pure
// function).
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "client/view/force_plot.hpp"

namespace hapticast::client {

inline const cv::Size kFilmSize_px(1280, 720);

/// Returns a line about the touch, such as "The object pushes the hand with 1.2 N."
[[nodiscard]] std::string filmCaption(const TickReport& report);

/// Returns a new picture of kFilmSize_px, CV_8UC3. `picture` is CV_8UC3 and belongs to the play
/// time of `report`. If it is empty, a dark ground replaces it. The force axis of the plot ends at
/// `top_N`, or above it if the history has a larger force.
[[nodiscard]] cv::Mat drawFilmFrame(const cv::Mat& picture, const TickReport& report,
                                    const Workspace& workspace, const ForceHistory& history,
                                    double top_N);

}  // namespace hapticast::client
