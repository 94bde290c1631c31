// SPDX-License-Identifier: MIT
// Live source from a camera that OpenNI2 supports (Kinect, Xtion, Astra and others). The camera's
// own processor registers depth to colour if it has this function. Thread: one; OpenNI2 has threads
// of its own.
#pragma once

#include <memory>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Opens a camera with OpenNI2. `device`: empty for the first one, its number from 0 on, or its
/// URI. `fps` > 0: requested rate, frames/s. Colour is RGB888, depth has units of 1 mm or 0.1 mm.
/// Registration and synchronisation are on where the camera has them, and mirroring is off. Throws
/// SourceError, also if this build has no OpenNI2.
[[nodiscard]] std::unique_ptr<RgbdSource> openOpenniCamera(const std::string& device, double fps);

}  // namespace hapticast::server
