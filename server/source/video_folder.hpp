// SPDX-License-Identifier: MIT
// Opens a colour video with a folder of depth images, such as a recording of Stray Scanner.
// Thread: any.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/source/rgbd_source.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Opens `folder` if it has a colour video and a folder of depth images (depth/, aligned_depth/,
/// depth_aligned/, depths/, depth_png/), and no folder of colour images. The video is rgb, color or
/// colour (rgb.mp4), else the only one. It reads camera_matrix.csv (the intrinsics of the video),
/// confidence/ and meta.json if they are there. `fps` > 0 overrides the rate, frames/s. Returns
/// null if `folder` is another kind of clip. Throws SourceError.
[[nodiscard]] std::unique_ptr<RgbdSource> openVideoFolder(const std::filesystem::path& folder,
                                                          double fps, const VideoLayout& layout);

/// Opens the colour video `color` with the depth images of the folder `depth`. Uses
/// camera_matrix.csv beside `color`, and confidence/ beside `depth`. Otherwise as above.
[[nodiscard]] std::unique_ptr<RgbdSource> openVideoWithDepth(const std::string& color,
                                                             const std::filesystem::path& depth,
                                                             double fps, const VideoLayout& layout);

}  // namespace hapticast::server
