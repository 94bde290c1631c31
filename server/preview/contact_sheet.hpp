// SPDX-License-Identifier: MIT
// The pictures of --preview. Each is a new one; nothing is drawn into what is given. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/preview/preview_frame.hpp"

namespace hapticast::server {

/// The frame at this size with the outline of each object, and in large pictures its number.
[[nodiscard]] cv::Mat drawOutlined(const PreviewFrame& frame, const cv::Size& size);
/// What is felt, as if lit from above left, as large as fits into the picture; black where nothing
/// is.
[[nodiscard]] cv::Mat drawRelief(const PreviewFrame& frame, const Workspace& workspace);
/// Outline and relief side by side (at least 960 px wide), with lines of text below.
[[nodiscard]] cv::Mat drawFirst(const PreviewFrame& frame, const Workspace& workspace,
                                const std::vector<std::string>& lines);
/// The frames in rows, each with outline and time.
[[nodiscard]] cv::Mat drawContactSheet(const std::vector<PreviewFrame>& frames);

}  // namespace hapticast::server
