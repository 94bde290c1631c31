// SPDX-License-Identifier: MIT
// Drawing of the --preview pictures. Each function returns a new picture and leaves its arguments
// unchanged. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/preview/preview_frame.hpp"

namespace hapticast::server {

/// Draws the frame at `size` with the outline of each object, and in large pictures its id.
[[nodiscard]] cv::Mat drawOutlined(const PreviewFrame& frame, const cv::Size& size);
/// Draws the heights, lit from above left and enlarged to the picture; black outside the objects.
[[nodiscard]] cv::Mat drawRelief(const PreviewFrame& frame, const Workspace& workspace);
/// Draws outline and relief side by side (at least 960 px wide), with `lines` of text below.
[[nodiscard]] cv::Mat drawFirst(const PreviewFrame& frame, const Workspace& workspace,
                                const std::vector<std::string>& lines);
/// Draws the frames in rows, each with outline and time. Requires at least one frame.
[[nodiscard]] cv::Mat drawContactSheet(const std::vector<PreviewFrame>& frames);

}  // namespace hapticast::server
