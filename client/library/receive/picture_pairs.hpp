// SPDX-License-Identifier: MIT
// Pairs the frames of a stream or a recording with their pictures. A picture belongs to the frame
// of its media time, and may arrive before it. Pictures arrive in the order of their frames: the
// frames before one with a picture go without, and so does a frame after which kMostLater others
// have come. Thread: one at a time.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "common/include/hapticast/frame.hpp"
#include "common/protocol/messages.hpp"

namespace hapticast::client {

class PicturePairs {
 public:
  /// Chosen: a picture follows its frame within a frame interval, unless the server drops it.
  static constexpr std::size_t kMostLater = 4;

  /// Without pictures no frame waits for one.
  explicit PicturePairs(bool has_pictures) : most_later_(has_pictures ? kMostLater : 0) {}

  /// Add the next frame, and the next picture.
  void add(Frame frame);
  void add(VideoFrame picture);
  /// Makes all frames go without a further picture.
  void finish() { ready_ = frames_.size(); }
  /// Removes all frames and pictures.
  void clear() { *this = PicturePairs(most_later_ > 0); }

  /// Returns the oldest frame, if it waits for no picture any more.
  [[nodiscard]] std::optional<Frame> next();

 private:
  std::size_t most_later_;
  std::deque<Frame> frames_;         // oldest first
  std::size_t ready_ = 0;            // so many wait for no picture
  std::deque<VideoFrame> pictures_;  // without a frame so far, at most kMostLater
};

}  // namespace hapticast::client
