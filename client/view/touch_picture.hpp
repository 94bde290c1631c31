// SPDX-License-Identifier: MIT
// Drawing of a touch, 1280 x 720 px, for film and screenshot: the video with the HIP and the
// forces, a caption, a legend, and a plot of the force. Thread: any (pure function).
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

inline const cv::Size kTouchPicture_px(1280, 720);
inline const cv::Size kTouchPlot_px(1280, 164);  ///< size of the plot, at the lower edge

/// Returns a new picture of kTouchPicture_px, CV_8UC3. `picture` is CV_8UC3 and belongs to the play
/// time of `report`. If `picture` is empty, a dark background replaces it. `caption` is written
/// above the picture. `plot` is CV_8UC3 of the size kTouchPlot_px.
[[nodiscard]] cv::Mat drawTouchPicture(const cv::Mat& picture, const TickReport& report,
                                       const Workspace& workspace, const std::string& caption,
                                       const cv::Mat& plot);

}  // namespace hapticast::client
