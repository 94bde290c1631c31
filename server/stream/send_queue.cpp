// SPDX-License-Identifier: MIT
#include "server/stream/send_queue.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::server {

namespace {
// Chosen: the share of sent pictures follows the last second, and a single skip is no reduction.
constexpr double kShareStep = 1.0 / 16.0;
constexpr double kReducedShare = 0.8;
}  // namespace

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
  if (video_) {
    ++counts_.videos_dropped;
    countPicture(0.0);
  }
  video_ = std::move(video);
}

void SendQueue::countPicture(double sent) { sent_share_ += kShareStep * (sent - sent_share_); }

void SendQueue::clearPictures() {
  video_.reset();
  picture_.reset();
}

void SendQueue::clearFrames() {
  needs_key_frame_ = true;
  frames_.clear();
  clearPictures();
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

SharedBytes SendQueue::pop(LocalTime now) {
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
  if (pacer_) return popPart(now);
  if (video_) {
    ++counts_.videos_sent;
    SharedBytes payload = std::move(video_->payload);
    video_.reset();
    return payload;
  }
  return nullptr;
}

SharedBytes SendQueue::popPart(LocalTime now) {
  if (!picture_ && !video_) return nullptr;
  const std::size_t most_bytes = pacer_->computePartBytes(now);
  if (most_bytes == 0) return nullptr;
  PicturePart part;
  if (!picture_) {
    ++counts_.videos_sent;
    countPicture(1.0);
    picture_ = std::move(video_->payload);
    picture_sent_bytes_ = 0;
    video_.reset();
    part.size = static_cast<std::uint32_t>(picture_->size());
  }
  const auto begin = picture_->begin() + static_cast<std::ptrdiff_t>(picture_sent_bytes_);
  const std::size_t size = std::min(most_bytes, picture_->size() - picture_sent_bytes_);
  part.data.assign(begin, begin + static_cast<std::ptrdiff_t>(size));
  part.reduced = sent_share_ < kReducedShare;
  picture_sent_bytes_ += size;
  if (picture_sent_bytes_ == picture_->size()) picture_.reset();
  return encodeShared(part);
}

}  // namespace hapticast::server
