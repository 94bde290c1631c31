// SPDX-License-Identifier: MIT
#include "server/stream/stale_frame_filter.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::server {

std::optional<EncodedFrame> StaleFrameFilter::push(EncodedFrame frame, MediaTime now,
                                                   Duration latency, Duration interval) {
  const Duration age = now - frame.media_time;
  if (held_) ++dropped_;
  held_.reset();
  const Duration tolerance = backlog_ ? std::min(2 * interval, kStaleAge) : kStaleAge;
  if (age > std::max(latency, usual_age_) + tolerance) {
    if (!backlog_ || age < backlog_->least_age - kFall) backlog_ = Backlog{age, now};
    if (now - backlog_->fell_at < kSettle) {
      release_at_ = now + 2 * interval;
      held_ = std::move(frame);
      return std::nullopt;
    }
  }
  backlog_.reset();
  usual_age_ = age;
  return frame;
}

std::optional<EncodedFrame> StaleFrameFilter::poll(MediaTime now) {
  if (!held_ || now < release_at_) return std::nullopt;
  return std::exchange(held_, std::nullopt);
}

void StaleFrameFilter::reset() {
  held_.reset();
  backlog_.reset();
  usual_age_ = {};
}

}  // namespace hapticast::server
