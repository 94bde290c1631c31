// SPDX-License-Identifier: MIT
// Drawing of the --preview pictures. Each function returns a new picture and leaves its arguments
// unchanged. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/preview/preview_frame.hpp"

namespace hapticast::server {

/// Returns the frame's picture, resized to `size`, with the outline of each object. Large pictures
/// also show each object's id.
[[nodiscard]] cv::Mat drawOutlined(const PreviewFrame& frame, const cv::Size& size);
/// Returns a picture of the heights, lit from above left and enlarged to the size of the frame. It
/// is black outside the objects.
[[nodiscard]] cv::Mat drawRelief(const PreviewFrame& frame, const Workspace& workspace);
/// Returns one picture, at least 960 px wide. It shows the outlined frame and its relief side by
/// side, and the text `lines` below them.
[[nodiscard]] cv::Mat drawFirst(const PreviewFrame& frame, const Workspace& workspace,
                                const std::vector<std::string>& lines);
/// Returns a picture of all frames in rows, each with outlines and its time. Requires at least one
/// frame.
[[nodiscard]] cv::Mat drawContactSheet(const std::vector<PreviewFrame>& frames);

}  // namespace hapticast::server
