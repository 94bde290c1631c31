// SPDX-License-Identifier: MIT
// Pairs the frames of a stream or a recording with their pictures. A picture belongs to the frame
// of its media time, and may arrive before it. Pictures arrive in the order of their frames: the
// frames before one with a picture go without, and so does a frame after which kMostLater others
// have come. Thread: one at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "common/include/hapticast/frame.hpp"
#include "common/protocol/messages.hpp"
#include "common/time.hpp"

namespace hapticast::client {

class PicturePairs {
 public:
  /// Chosen: a picture follows its frame within a frame interval, unless the server drops it.
  static constexpr std::size_t kMostLater = 4;

  /// Without pictures no frame waits for one.
  explicit PicturePairs(bool has_pictures) : most_later_(has_pictures ? kMostLater : 0) {}

  /// Add the next frame, and the next picture.
  void add(Frame frame) {
    frames_.push_back(std::move(frame));
    if (frames_.size() > most_later_) ready_ = std::max(ready_, frames_.size() - most_later_);
    for (auto each = pictures_.begin(); each != pictures_.end();)
      each = findPair(*each) ? pictures_.erase(each) : each + 1;
  }
  void add(VideoFrame picture) {
    if (findPair(picture)) return;
    pictures_.push_back(std::move(picture));
    if (pictures_.size() > most_later_) pictures_.pop_front();
  }
  /// Makes all frames go without a further picture.
  void finish() { ready_ = frames_.size(); }

  /// Returns the oldest frame, unless it waits for its picture.
  [[nodiscard]] std::optional<Frame> next() {
    if (ready_ == 0) return std::nullopt;
    --ready_;
    Frame frame = std::move(frames_.front());
    frames_.pop_front();
    return frame;
  }

 private:
  /// Gives the picture to its frame, if that has arrived. Returns whether it has.
  bool findPair(VideoFrame& picture) {
    const double time_s = toSeconds(picture.media_time);
    const auto frame = std::find_if(frames_.begin(), frames_.end(),
                                    [=](const Frame& each) { return each.time_s == time_s; });
    if (frame == frames_.end()) return false;
    frame->jpeg = std::move(picture.jpeg);
    ready_ = std::max(ready_, static_cast<std::size_t>(frame - frames_.begin()) + 1);
    return true;
  }

  std::size_t most_later_;
  std::deque<Frame> frames_;         // oldest first
  std::size_t ready_ = 0;            // so many do not wait
  std::deque<VideoFrame> pictures_;  // without a frame so far, at most kMostLater
};

}  // namespace hapticast::client
