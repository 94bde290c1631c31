// SPDX-License-Identifier: MIT
#include "client/library/receive/frame_inbox.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace hapticast::client {

void FrameInbox::release() {
  while (auto frame = pairs_.next()) frames_.push_back(std::move(*frame));
  for (; frames_.size() > max_waiting_; ++dropped_) frames_.pop_front();
  changed_.notify_all();
}

void FrameInbox::end(const std::string& error) {
  const std::lock_guard lock(mutex_);
  if (ended_) return;
  pairs_.finish();
  release();
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
