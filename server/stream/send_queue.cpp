// SPDX-License-Identifier: MIT
#include "server/stream/send_queue.hpp"

#include <utility>

namespace hapticast::server {

SendCounts& SendCounts::operator+=(const SendCounts& other) {
  frames_sent += other.frames_sent;
  videos_sent += other.videos_sent;
  frames_dropped_full += other.frames_dropped_full;
  frames_dropped_old += other.frames_dropped_old;
  videos_dropped += other.videos_dropped;
  return *this;
}

bool SendQueue::pushControl(SharedBytes payload) {
  if (control_.size() >= kMaxControl) return false;
  control_.push_back(std::move(payload));
  return true;
}

void SendQueue::dropOldest(std::uint64_t& cause) {
  frames_.pop_front();
  needs_key_frame_ = true;
  ++cause;
}

void SendQueue::requireKeyFrame() {
  while (!frames_.empty()) dropOldest(counts_.frames_dropped_old);
  needs_key_frame_ = true;
}

void SendQueue::pushFrame(EncodedFrame frame) {
  while (!frames_.empty() && frames_.front().media_time + kMaxAge < frame.media_time) {
    dropOldest(counts_.frames_dropped_old);
  }
  if (frames_.size() >= kMaxFrames) dropOldest(counts_.frames_dropped_full);
  frames_.push_back(std::move(frame));
}

void SendQueue::pushVideo(EncodedVideo video) {
  if (video_) ++counts_.videos_dropped;
  video_ = std::move(video);
}

void SendQueue::clearFrames() {
  needs_key_frame_ = true;
  frames_.clear();
  video_.reset();
}

void SendQueue::clear() {
  clearFrames();
  control_.clear();
  description_.reset();
}

SharedBytes SendQueue::pass(const EncodedFrame& frame) {
  ++counts_.frames_sent;
  return std::exchange(needs_key_frame_, false) ? frame.key_frame->payload() : frame.delta;
}

SharedBytes SendQueue::pop() {
  if (!control_.empty()) {
    SharedBytes payload = std::move(control_.front());
    control_.pop_front();
    return payload;
  }
  if (description_) return std::exchange(description_, nullptr);
  if (!frames_.empty()) {
    const EncodedFrame frame = std::move(frames_.front());
    frames_.pop_front();
    return pass(frame);
  }
  if (video_) {
    ++counts_.videos_sent;
    SharedBytes payload = std::move(video_->payload);
    video_.reset();
    return payload;
  }
  return nullptr;
}

}  // namespace hapticast::server
