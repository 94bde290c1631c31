// SPDX-License-Identifier: MIT
// The user's own programs that add depth and masks to the pictures of a source. Plain values
// without OpenCV. Thread: any.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// Values of --depth-from, --depth-cache, --depth-cache-limit and --mask-from.
struct ChildSettings {
  std::string depth_command;  ///< empty: the source has depth
  std::string depth_cache;    ///< folder of the cache; empty: none
  double depth_cache_GB = 10.0;
  std::string mask_command;  ///< empty: the server segments by itself
  bool operator==(const ChildSettings&) const = default;
};

/// Function that a source calls about 20 times a second while it waits for a child. Returns false
/// to end the wait; the source then behaves as at the end of the clip. Thread: that of the source.
using KeepWaiting = std::function<bool()>;

/// Depths of the nearest and the farthest 2 % of the first picture, where a program states relative
/// depth and the author states no --depth-range. Chosen: at a desk and in a room, things then have
/// about their true proportions.
inline constexpr DepthRange kRelativeRange{600.0, 1200.0};

}  // namespace hapticast::server
