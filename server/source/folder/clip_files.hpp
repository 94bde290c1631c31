// SPDX-License-Identifier: MIT
// Finds the files of an image sequence in its folder: colour, depth, masks and the author's
// declarations. findClipFiles() describes the supported layouts. It decodes no image. Thread: any.
#pragma once

#include <filesystem>

#include "server/source/folder/frame_files.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Returns the files of the clip in `folder`, with the declarations of its meta.json if it has one.
/// Throws SourceError. The layouts are:
///
/// * TUM RGB-D: rgb.txt and depth.txt have lines "timestamp file". Each colour frame is paired with
///   the nearest depth frame at most 20 ms away. No depth frame is used twice (timed_images.hpp).
///   Depth has 5000 units per metre, and the field of view is a Kinect's.
///
/// * Otherwise the images of findImages(). If all names are time stamps and images are missing,
///   they are paired by time (pairByStamps()). Otherwise, if there are as many depth images as
///   colour images, they are paired in the order of their names (numbers in names count by value).
///   One warning is logged if the frame numbers of a pair differ. Otherwise they are paired by the
///   frame numbers in their names. A colour image without depth is then a gap. In place of depth
///   images there may be one array with as many pictures as there are colour images.
///
/// * BOP: the second layout with scene_camera.json (bop_scene.hpp).
///
/// * Otherwise the second layout may also have mask/. If mask/ has as many files as there are
///   colour images, each frame has a mask. If it has fewer, they are key masks for the colour
///   images of the same names.
///
/// * With VideoLayout::color_only no layout needs depth images, and the frames have none.
[[nodiscard]] ClipFiles findClipFiles(const std::filesystem::path& folder,
                                      const VideoLayout& layout = {});

}  // namespace hapticast::server
