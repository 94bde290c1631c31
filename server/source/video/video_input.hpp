// SPDX-License-Identifier: MIT
// What a video is read from. Thread: any.
#pragma once

#include <functional>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Error: a file has no video.
class NoVideoError : public SourceError {
 public:
  using SourceError::SourceError;
};

/// A stream that another machine or program sends.
struct NetworkStream {
  std::string url;   ///< address for FFmpeg; it may contain a password, so no message shows it
  std::string name;  ///< its name in messages
  /// Returns true to interrupt a wait for the network. VideoFile then behaves as at the end of the
  /// stream. VideoFile calls it in the thread that uses VideoFile, at least about ten times a
  /// second.
  std::function<bool()> give_up;
};

}  // namespace hapticast::server
