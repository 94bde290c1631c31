// SPDX-License-Identifier: MIT
// Keeps what the screenshot shows: the force over time, and the picture of the strongest touch.
// Thread: take() any, everything else main.
#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "client/haptics/tick_report.hpp"
#include "client/view/overlay.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast::client {

class Viewer {
 public:
  /// Throws std::runtime_error unless `file` ends as a picture does, such as .png.
  static void requirePictureName(const std::string& file);

  /// A picture from the stream; kept for the moments around its time.
  void take(VideoFrame picture);
  /// One tick, in order, shortly after it happened.
  void add(const TickReport& report);
  /// Writes the screenshot. Throws std::runtime_error naming the file when it cannot be written.
  void write(const std::string& file, const Workspace& workspace) const;

 private:
  static constexpr std::size_t kPictures = 64;

  [[nodiscard]] std::optional<VideoFrame> pictureAt(MediaTime time);

  Overlay overlay_;
  TickReport strongest_;  // or the last one while nothing was touched
  std::optional<VideoFrame> picture_;
  std::mutex mutex_;
  std::deque<VideoFrame> pictures_;  // guarded by mutex_
};

}  // namespace hapticast::client
