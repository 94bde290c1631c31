// SPDX-License-Identifier: MIT
// Finds the files of an image sequence in its folder: colour, depth, masks and the author's
// declarations. findClipFiles() describes the supported layouts. It decodes no image. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/source/camera_model.hpp"
#include "server/source/folder/clip_meta.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Files of one frame.
struct FrameFiles {
  std::filesystem::path color;
  std::filesystem::path depth;  ///< empty: the frame is a gap, or the clip has colour only
  std::filesystem::path mask;   ///< mask file; empty: the frame has none
  /// Mask files of single objects, in the BOP layout only. Element n is the mask of object n + 1.
  /// An empty path means that this frame has no mask of that object. An empty vector means that the
  /// clip has no masks of single objects.
  std::vector<std::filesystem::path> object_masks;
  std::optional<double> mm_per_unit;  ///< of this frame's depth; nullopt: as the clip's
  std::uint64_t array_index = 0;      ///< picture of ClipFiles::depth_array
};

/// Files of a clip with their declarations.
struct ClipFiles {
  std::vector<FrameFiles> frames;  ///< in order of time, at least one
  /// File with the depth of all frames (npy_stack.hpp), which FrameFiles::depth names too. Empty:
  /// each frame has a file of its own.
  std::filesystem::path depth_array;
  /// True: the masks are key masks, which only some frames have.
  bool key_masks = false;
  double fps = 25.0;                       ///< frames/s
  std::optional<int> declared_depth_bits;  ///< bits of depth that the author declared, 8 or 16
  /// mm for each unit of depth. Not declared: 1 for 16 bits, 1000 for float.
  std::optional<double> mm_per_unit;
  std::optional<CameraModel> camera;
  std::optional<double> fov_deg;  ///< horizontal field of view, if no camera is declared
  std::optional<int> declared_width_px;
  std::optional<int> declared_height_px;
};

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
