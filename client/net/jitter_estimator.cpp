// SPDX-License-Identifier: MIT
#include "client/net/jitter_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hapticast::client {

namespace {
constexpr std::size_t kMaxSamples = std::size_t{5} * 240;  // the window at the highest frame rate
}

void JitterEstimator::add(LocalTime arrival, Duration needed) {
  // Clamped to the possible delays, so that a wild lateness cannot overflow.
  samples_.push_back({arrival, std::clamp(needed, -kMaxDelay, kMaxDelay)});
  while (samples_.front().arrival + kWindow < arrival || samples_.size() > kMaxSamples) {
    samples_.pop_front();
  }
}

void JitterEstimator::shift(Duration by) {
  if (by == Duration::zero()) return;
  for (Sample& each : samples_)
    each.needed += std::clamp(by, -kMaxDelay - each.needed, kMaxDelay - each.needed);
}

Duration JitterEstimator::delay(Duration least) const {
  if (samples_.empty()) return std::min(least + kMargin, kMaxDelay);
  std::vector<Duration> needed;
  needed.reserve(samples_.size());
  for (const Sample& each : samples_) needed.push_back(each.needed);
  const std::size_t most = needed.size() - (needed.size() < kFewFrames ? 0 : 1);
  const auto covered =
      static_cast<std::size_t>(std::ceil(kQuantile * static_cast<double>(needed.size())));
  const auto rank = static_cast<std::ptrdiff_t>(std::min(covered, most)) - 1;
  std::nth_element(needed.begin(), needed.begin() + rank, needed.end());
  return std::clamp(needed[static_cast<std::size_t>(rank)] + kMargin, std::min(least, kMaxDelay),
                    kMaxDelay);
}

}  // namespace hapticast::client
