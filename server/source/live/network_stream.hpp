// SPDX-License-Identifier: MIT
// Network stream with colour and depth as a live source. Time stamps of the stream become times of
// capture (CaptureClock). Short silence keeps the connection, longer silence ends it.
// Thread: one.
#pragma once

#include <memory>
#include <string>

#include "server/source/rgbd_source.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Connects to `url`, decodes the first frame and returns the source. `fps` > 0 states the rate of
/// the stream, frames/s. Throws SourceError. No message has a password of `url`.
std::unique_ptr<RgbdSource> openNetworkStream(const std::string& url, const VideoLayout& layout,
                                              double fps);

}  // namespace hapticast::server
