// SPDX-License-Identifier: MIT
// Drawing of the --preview pictures. Each function returns a new picture and leaves its arguments
// unchanged. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/preview/preview_frame.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns `part` of `frame.color` (px, inside the picture), resized to `size`, with the outline of
/// each object. It also shows each object's id if `size` is wider than a thumbnail (240 px).
[[nodiscard]] cv::Mat drawOutlined(const PreviewFrame& frame, const cv::Rect& part,
                                   const cv::Size& size);
/// Returns a picture of the heights, lit from above left and enlarged to the size of the frame. It
/// is black outside the objects.
[[nodiscard]] cv::Mat drawRelief(const PreviewFrame& frame, const Workspace& workspace);
/// Returns one picture. It shows panels of 480 to 960 px side by side, and the text `lines` below
/// them. The first panel is the outlined frame with pixel axes. Small objects have a close-up
/// beside it, with axes too. The last panel is the relief. Frame and close-up show the points of
/// `settings` that belong to the first frame: --object as a green cross, --not as a red tilted one.
[[nodiscard]] cv::Mat drawFirst(const PreviewFrame& frame, const Workspace& workspace,
                                const VisionSettings& settings,
                                const std::vector<std::string>& lines);
/// Returns a picture of all frames in rows, each with outlines and its time. All frames show the
/// same part of the picture, a close-up if the objects stay in a small part. Each point of
/// `settings` is drawn in the frame that is nearest in time. Requires at least one frame.
[[nodiscard]] cv::Mat drawContactSheet(const std::vector<PreviewFrame>& frames,
                                       const VisionSettings& settings);

/// Returns the candidates for the first mask side by side, each with its number. All show the same
/// part of the picture. Requires at least one.
[[nodiscard]] cv::Mat drawCandidates(const std::vector<PreviewFrame>& candidates,
                                     const VisionSettings& settings);

}  // namespace hapticast::server
