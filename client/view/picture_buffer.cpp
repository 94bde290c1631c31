// SPDX-License-Identifier: MIT
#include "client/view/picture_buffer.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

void PictureBuffer::add(VideoFrame video, const Workspace& workspace) {
  const std::size_t size = video.jpeg.size();
  auto picture = std::make_shared<const StreamPicture>(StreamPicture{std::move(video), workspace});
  const std::lock_guard lock(mutex_);
  if (!pictures_.empty() && picture->video.media_time < pictures_.back()->video.media_time) {
    pictures_.clear();
    bytes_ = 0;
  }
  pictures_.push_back(std::move(picture));
  bytes_ += size;
  while (pictures_.size() > kMaxPictures || (bytes_ > kMaxBytes && pictures_.size() > 1)) {
    bytes_ -= pictures_.front()->video.jpeg.size();
    pictures_.pop_front();
  }
}

std::shared_ptr<const StreamPicture> PictureBuffer::nearest(MediaTime time) const {
  const auto distance = [time](const auto& picture) {
    return std::abs((picture->video.media_time - time).count());
  };
  const std::lock_guard lock(mutex_);
  const auto found =
      std::min_element(pictures_.begin(), pictures_.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  return found == pictures_.end() ? nullptr : *found;
}

}  // namespace hapticast::client
