// SPDX-License-Identifier: MIT
#include "client/library/receive/picture_pairs.hpp"

#include <algorithm>
#include <utility>

#include "common/time.hpp"

namespace hapticast::client {

namespace {

// The time of a frame of the library is that of toSeconds().
bool isPair(const Frame& frame, const VideoFrame& picture) {
  return frame.time_s == toSeconds(picture.media_time);
}

}  // namespace

void PicturePairs::add(Frame frame) {
  const auto picture =
      std::find_if(pictures_.begin(), pictures_.end(),
                   [&frame](const VideoFrame& each) { return isPair(frame, each); });
  frames_.push_back(std::move(frame));
  if (picture != pictures_.end()) {
    frames_.back().jpeg = std::move(picture->jpeg);
    pictures_.erase(pictures_.begin(), picture + 1);
    ready_ = frames_.size();
  } else if (frames_.size() > most_later_) {
    ready_ = std::max(ready_, frames_.size() - most_later_);
  }
}

void PicturePairs::add(VideoFrame picture) {
  const auto frame = std::find_if(frames_.begin(), frames_.end(),
                                  [&picture](const Frame& each) { return isPair(each, picture); });
  if (frame != frames_.end()) {
    frame->jpeg = std::move(picture.jpeg);
    ready_ = std::max(ready_, static_cast<std::size_t>(frame - frames_.begin()) + 1);
    return;
  }
  pictures_.push_back(std::move(picture));
  if (pictures_.size() > most_later_) pictures_.pop_front();
}

std::optional<Frame> PicturePairs::next() {
  if (ready_ == 0) return std::nullopt;
  Frame frame = std::move(frames_.front());
  frames_.pop_front();
  --ready_;
  return frame;
}

}  // namespace hapticast::client
