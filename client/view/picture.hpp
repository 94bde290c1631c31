// SPDX-License-Identifier: MIT
// JPEG decoder for pictures of the stream.
// Thread: any (pure function).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <span>

#include "common/haptic_frame.hpp"

namespace hapticast::client {

/// Decodes `jpeg`. Returns CV_8UC3 (BGR), empty unless `jpeg` is a complete, valid JPEG of the size
/// `expected`. The header of a JPEG determines the memory of its decoder. So the size is checked
/// before the decoding.
[[nodiscard]] cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected);

// Buffer of the last seconds of pictures, with access by media time: a picture arrives earlier than
// the loop plays its frame. Bounded.
// Thread: any; a mutex guards the buffer for short times.

/// A coded picture and its workspace.
struct StreamPicture {
  VideoFrame video;
  Workspace workspace;
};

class PictureBuffer {
 public:
  /// Covers the longest playout delay: 2 s (JitterEstimator::kMaxDelay) are 50 pictures at 25
  /// frames/s.
  static constexpr std::size_t kMaxPictures = 64;
  /// Chosen: 64 pictures of 1920 x 1080 px with about 0.5 MB each fit.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// Adds a picture, and drops the oldest ones above the limits. A picture older than the newest
  /// one belongs to a restarted server: all earlier pictures are then void.
  void add(VideoFrame video, const Workspace& workspace);
  /// Returns the picture nearest to `time`; null if the buffer is empty.
  [[nodiscard]] std::shared_ptr<const StreamPicture> nearest(MediaTime time) const;

 private:
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<const StreamPicture>> pictures_;  // guarded by mutex_; oldest first
  std::size_t bytes_ = 0;                                      // guarded by mutex_; of all JPEGs
};

}  // namespace hapticast::client
