// SPDX-License-Identifier: MIT
// Network stream with colour and depth as a live source. CaptureClock converts time stamps of the
// stream to capture times. The connection remains during a short silence. After a longer silence
// the source reconnects. Thread: one.
#pragma once

#include <memory>
#include <string>

#include "server/source/rgbd_source.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Connects to `url`, decodes the first frame and returns the source. `fps`: rate of the stream,
/// frames/s; 0: the rate that the stream states. Blocks for at most about 20 s. Throws SourceError
/// if no frame arrives, or if colour and depth do not have the form in `layout`. No error message
/// contains a password of `url`.
std::unique_ptr<RgbdSource> openNetworkStream(const std::string& url, const VideoLayout& layout,
                                              double fps);

}  // namespace hapticast::server
