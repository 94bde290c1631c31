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

/// Connects to `url`, decodes the first frame and returns the source. `fps` > 0 states the rate of
/// the stream, frames/s. Throws SourceError. No error message contains a password of `url`.
std::unique_ptr<RgbdSource> openNetworkStream(const std::string& url, const VideoLayout& layout,
                                              double fps);

}  // namespace hapticast::server
