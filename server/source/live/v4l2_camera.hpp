// SPDX-License-Identifier: MIT
// Live source from two nodes of Video4Linux2: one for colour, one for depth of 16 bits (Z16, for
// example of a RealSense) or 8 bits (grey). Thread: one.
#pragma once

#include <memory>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Opens the nodes `color` and `depth`, paths such as /dev/video2. An empty `depth`: the source
/// delivers colour only. The formats are those of
/// v4l2_picture.hpp. It requests 640x480 from both; depth of the same aspect ratio is scaled to the
/// size of the colour. `fps` > 0: requested rate, frames/s. `mm_per_unit`: unit of 16-bit depth,
/// mm. Throws SourceError.
[[nodiscard]] std::unique_ptr<RgbdSource> openV4l2Camera(const std::string& color,
                                                         const std::string& depth, double fps,
                                                         double mm_per_unit = 1.0);

}  // namespace hapticast::server
