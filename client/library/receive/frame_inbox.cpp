// SPDX-License-Identifier: MIT
#include "client/library/receive/frame_inbox.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace hapticast::client {

namespace {
// A frame goes without its picture when so many later frames have arrived. Chosen: a picture
// follows its frame within a frame interval, unless the server drops it.
constexpr std::size_t kWaitsForPicture = 4;
}  // namespace

void FrameInbox::push(Frame frame) {
  const std::lock_guard lock(mutex_);
  without_picture_.push_back(std::move(frame));
  const std::size_t keep = pictures_ ? kWaitsForPicture : 0;
  if (without_picture_.size() > keep) release(without_picture_.size() - keep);
}

void FrameInbox::push(std::uint64_t id, std::vector<std::uint8_t> jpeg) {
  const std::lock_guard lock(mutex_);
  const auto frame = std::find_if(without_picture_.begin(), without_picture_.end(),
                                  [id](const Frame& each) { return each.id == id; });
  if (frame == without_picture_.end()) return;
  frame->jpeg = std::move(jpeg);
  release(static_cast<std::size_t>(frame - without_picture_.begin()) + 1);
}

void FrameInbox::release(std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    frames_.push_back(std::move(without_picture_.front()));
    without_picture_.pop_front();
  }
  for (; frames_.size() > max_waiting_; ++dropped_) frames_.pop_front();
  changed_.notify_all();
}

void FrameInbox::end(const std::string& error) {
  const std::lock_guard lock(mutex_);
  if (ended_) return;
  release(without_picture_.size());
  ended_ = true;
  error_ = error;
  changed_.notify_all();
}

std::optional<Frame> FrameInbox::pop(double timeout_s) {
  std::unique_lock lock(mutex_);
  const auto ready = [this] { return ended_ || !frames_.empty(); };
  constexpr double kLongest_s = 1e6;  // a longer wait overflows the clock of some systems
  if (timeout_s < 0.0) {
    changed_.wait(lock, ready);
  } else {
    changed_.wait_for(lock, std::chrono::duration<double>(std::min(timeout_s, kLongest_s)), ready);
  }
  if (!frames_.empty()) {
    Frame frame = std::move(frames_.front());
    frames_.pop_front();
    return frame;
  }
  if (!error_.empty()) throw std::runtime_error(error_);
  return std::nullopt;
}

std::uint64_t FrameInbox::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

bool FrameInbox::ended() const {
  const std::lock_guard lock(mutex_);
  return ended_ && frames_.empty();
}

}  // namespace hapticast::client
