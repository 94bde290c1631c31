// SPDX-License-Identifier: MIT
// The files of an image sequence, and what its author declared. Thread: any.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "server/source/camera_model.hpp"

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

}  // namespace hapticast::server
