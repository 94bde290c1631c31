// SPDX-License-Identifier: MIT
#include "server/stream/stale_frame_filter.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::server {

std::optional<EncodedFrame> StaleFrameFilter::push(EncodedFrame frame, MediaTime now,
                                                   Duration latency, Duration interval) {
  const Duration age = now - frame.media_time;
  if (held_) ++dropped_;
  if (age > std::max(latency, usual_age_) + kStaleAge) {
    if (!held_) release_at_ = now + 2 * interval;
    held_ = std::move(frame);
    return poll(now);
  }
  held_.reset();
  usual_age_ = age;
  return frame;
}

std::optional<EncodedFrame> StaleFrameFilter::poll(MediaTime now) {
  if (!held_ || now < release_at_) return std::nullopt;
  usual_age_ = now - held_->media_time;
  return std::exchange(held_, std::nullopt);
}

void StaleFrameFilter::reset() {
  held_.reset();
  usual_age_ = {};
}

}  // namespace hapticast::server
