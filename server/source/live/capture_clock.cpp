// SPDX-License-Identifier: MIT
#include "server/source/live/capture_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hapticast::server {

namespace {

constexpr std::int64_t kDrift = 1000;    // chosen: the offset may grow by 1 ms in a second
constexpr double kLargestStamp_s = 1e9;  // keeps nanoseconds in 64 bits

}  // namespace

bool CaptureClock::isOfBurst(Duration offset, LocalTime arrived) {
  const bool late = offset - *offset_ > kLate;
  const bool early = offset - *offset_ < -kEarly;
  if (early) offset_ = offset;
  if (!late && !early) {
    burst_since_.reset();
    return false;
  }
  if (!burst_since_) burst_since_ = arrived;
  if (arrived - *burst_since_ < kPatience) return true;
  if (late) burst_since_.reset();
  offset_ = offset;
  return false;
}

std::optional<LocalTime> CaptureClock::capture(double stamp_s, LocalTime arrived) {
  const Duration passed = arrived - last_arrived_;
  last_arrived_ = arrived;
  LocalTime captured = arrived;
  if (std::isfinite(stamp_s) && std::abs(stamp_s) < kLargestStamp_s) {
    const Duration stamp = fromSeconds(stamp_s);
    const Duration offset = arrived.time_since_epoch() - stamp;
    if (!offset_) {
      offset_ = offset;
      return std::nullopt;
    }
    if (isOfBurst(offset, arrived)) return std::nullopt;
    offset_ = std::min(offset, *offset_ + passed / kDrift);
    captured = LocalTime(stamp + *offset_);
  }
  last_captured_ = std::max(last_captured_, captured);
  return last_captured_;
}

}  // namespace hapticast::server
