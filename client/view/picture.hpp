// SPDX-License-Identifier: MIT
// JPEG decoder for the pictures of the stream, and PNG writer for drawings.
// Thread: any, but not the haptic loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

#include "common/haptic_frame.hpp"
#include "common/media/media_module.hpp"
#include "common/result.hpp"

namespace hapticast::client {

/// Decodes `jpeg` and returns the picture, CV_8UC3 (BGR). Returns an empty picture if `jpeg` is not
/// a complete, valid JPEG of the size `expected`. The size is checked before the decoding, because
/// the header of a JPEG determines how much memory its decoder allocates.
[[nodiscard]] cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected);

/// Returns the pixels of `picture`, CV_8UC3 (BGR), without a copy.
[[nodiscard]] BgrPixels viewPixels(const cv::Mat& picture);

/// Writes `picture`, CV_8UC3 (BGR), to the PNG file `file`. Opens the media module for it. Returns
/// an error without the file's name ("cannot be written (...)"), or nullopt.
[[nodiscard]] std::optional<Error> writePicture(const std::string& file, const cv::Mat& picture);

/// A JPEG picture and the workspace of its stream.
struct StreamPicture {
  VideoFrame video;
  Workspace workspace;
};

/// Buffer with the pictures of the last seconds. A picture arrives before the loop plays its frame.
/// So the buffer stores pictures, and a view requests one by its media time. The size of the buffer
/// is bounded. Thread: any; a mutex guards the buffer for short times.
class PictureBuffer {
 public:
  /// Largest number of pictures. It covers the longest playout delay: 2 s
  /// (JitterEstimator::kMaxDelay) are 50 pictures at 25 frames/s.
  static constexpr std::size_t kMaxPictures = 64;
  /// Largest number of bytes of all pictures. The value is a choice: 64 pictures of 1920 x 1080 px
  /// with about 0.5 MB each fit.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// Adds a picture, and removes the oldest ones above the limits. A picture that is older than the
  /// newest one belongs to a restarted server. The buffer then removes all earlier pictures.
  void add(VideoFrame video, const Workspace& workspace);
  /// Returns the picture whose media time is nearest to `time`. Returns null if the buffer is
  /// empty.
  [[nodiscard]] std::shared_ptr<const StreamPicture> findNearest(MediaTime time) const;

 private:
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<const StreamPicture>> pictures_;  // guarded by mutex_; oldest first
  std::size_t bytes_ = 0;                                      // guarded by mutex_; of all JPEGs
};

}  // namespace hapticast::client
