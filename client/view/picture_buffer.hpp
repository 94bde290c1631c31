// SPDX-License-Identifier: MIT
// The pictures of the last seconds, to be found by their time: a picture comes earlier than the
// loop plays its moment. Bounded. Thread: any; the buffer has a lock of its own, which is held for
// moments only.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>

#include "common/haptic_frame.hpp"

namespace hapticast::client {

/// A picture as it came, not decoded yet, and the workspace that was announced for it.
struct StreamPicture {
  VideoFrame video;
  Workspace workspace;
};

class PictureBuffer {
 public:
  /// The playout delay is at most 2 s (JitterEstimator::kMaxDelay), at 25 frames/s 50 pictures.
  static constexpr std::size_t kMaxPictures = 64;
  /// Chosen: a picture of 1920 x 1080 takes about 0.5 MB, so that 64 of them fit.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// Adds a picture and forgets the oldest ones beyond the bounds. A picture that is older than the
  /// newest one belongs to a server that has started anew: then all pictures before it are void.
  void add(VideoFrame video, const Workspace& workspace);
  /// The picture nearest to `time`; null when there is none.
  [[nodiscard]] std::shared_ptr<const StreamPicture> nearest(MediaTime time) const;

 private:
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<const StreamPicture>> pictures_;  // guarded by mutex_; oldest first
  std::size_t bytes_ = 0;                                      // guarded by mutex_; of all JPEGs
};

}  // namespace hapticast::client
