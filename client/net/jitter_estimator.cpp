// SPDX-License-Identifier: MIT
#include "client/net/jitter_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hapticast::client {

namespace {
constexpr std::size_t kMaxSamples = 5 * 240;  // the window at the highest frame rate
}

void JitterEstimator::add(LocalTime arrival, Duration lateness) {
  samples_.push_back({arrival, lateness});
  while (samples_.front().arrival + kWindow < arrival || samples_.size() > kMaxSamples) {
    samples_.pop_front();
  }
}

Duration JitterEstimator::delay(Duration frame_interval, int intervals) const {
  const Duration least = frame_interval * intervals;
  if (samples_.empty()) return std::min(least + kMargin, kMaxDelay);
  std::vector<Duration> lateness;
  lateness.reserve(samples_.size());
  for (const Sample& each : samples_) lateness.push_back(each.lateness);
  const auto rank =
      static_cast<std::ptrdiff_t>(std::ceil(kQuantile * static_cast<double>(lateness.size()))) - 1;
  std::nth_element(lateness.begin(), lateness.begin() + rank, lateness.end());
  // Held to the limit before adding: a wild lateness must not overflow.
  const Duration quantile =
      std::clamp(lateness[static_cast<std::size_t>(rank)], -kMaxDelay, kMaxDelay);
  return std::clamp(quantile + kMargin + least, std::min(least, kMaxDelay), kMaxDelay);
}

}  // namespace hapticast::client
