// SPDX-License-Identifier: MIT
#include "client/net/jitter_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace hapticast::client {

namespace {
constexpr std::size_t kMaxSamples = std::size_t{5} * 240;  // the window at the highest frame rate
}

void JitterEstimator::reset(LocalTime now) {
  samples_.clear();
  last_arrival_ = now;
  outage_end_ = now;
}

void JitterEstimator::add(const FrameArrival& frame, Duration interval) {
  // Clamped to the possible delays, so that a wild lateness cannot overflow.
  const Duration needed = std::clamp(frame.needed, -kMaxDelay, kMaxDelay);
  const auto outage = findOutage(frame, interval);
  const auto event = std::find_if(samples_.rbegin(), samples_.rend(), [&](const Sample& each) {
    return outage && each.outage_end == outage;
  });
  Sample sample{frame.at, needed, outage};
  if (event != samples_.rend()) {
    sample.needed = std::max(event->needed, needed);
    samples_.erase(std::next(event).base());
  }
  samples_.push_back(sample);
  while (samples_.front().arrival + kWindow < frame.at || samples_.size() > kMaxSamples)
    samples_.pop_front();
}

std::optional<LocalTime> JitterEstimator::findOutage(const FrameArrival& frame, Duration interval) {
  const auto last = std::exchange(last_arrival_, frame.at);
  if (last && frame.at - *last > std::max(kOutage, kOutage_intervals * interval))
    outage_end_ = frame.at;
  const bool delayed = outage_end_ && frame.previous_due < *outage_end_;
  return delayed ? outage_end_ : std::nullopt;
}

void JitterEstimator::shift(Duration by) {
  if (by == Duration::zero()) return;
  for (Sample& each : samples_)
    each.needed += std::clamp(by, -kMaxDelay - each.needed, kMaxDelay - each.needed);
}

std::optional<Duration> JitterEstimator::findSecondOutage() const {
  std::optional<Duration> first;
  std::optional<Duration> second;
  for (const Sample& each : samples_) {
    if (!each.outage_end) continue;
    if (!first || each.needed > *first) {
      second = std::exchange(first, each.needed);
    } else if (!second || each.needed > *second) {
      second = each.needed;
    }
  }
  return second;
}

Duration JitterEstimator::delay(Duration least) const {
  std::vector<Duration> needed;
  needed.reserve(samples_.size());
  for (const Sample& each : samples_) {
    if (!each.outage_end) needed.push_back(each.needed);
  }
  Duration delay = least;
  if (!needed.empty()) {
    const std::size_t most = needed.size() - (needed.size() < kFewFrames ? 0 : 1);
    const auto covered =
        static_cast<std::size_t>(std::ceil(kQuantile * static_cast<double>(needed.size())));
    const auto rank = static_cast<std::ptrdiff_t>(std::min(covered, most)) - 1;
    std::nth_element(needed.begin(), needed.begin() + rank, needed.end());
    delay = needed[static_cast<std::size_t>(rank)];
  }
  if (const auto second = findSecondOutage()) delay = std::max(delay, *second);
  return std::clamp(delay + kMargin, std::min(least, max_delay_), max_delay_);
}

}  // namespace hapticast::client
