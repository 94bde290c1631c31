// SPDX-License-Identifier: MIT
#include "client/haptics/playback/playout.hpp"

#include <algorithm>
#include <cstdint>

namespace hapticast::client {

namespace {
constexpr std::int64_t kRateDivisor = 50;  // 2 %
constexpr Duration kLongestDelay{10'000'000'000};
// Keeps a sum of three times within 64 bits, for any value of a server's clock.
constexpr Duration kLargestOffset{std::int64_t{1} << 61};

Duration clampTo(Duration value, Duration limit) noexcept {
  return std::clamp(value, -limit, limit);
}

/// Moves `value` towards `target` by at most `budget`, and reduces `budget` by the step.
void approach(Duration& value, Duration target, Duration& budget) noexcept {
  const Duration step = clampTo(target - value, budget);
  value += step;
  budget -= std::max(step, -step);
}
}  // namespace

MediaTime Playout::advance(LocalTime now, const StreamTiming& stream, bool in_contact,
                           const UserControls& user) noexcept {
  const Duration local = clampTo(now.time_since_epoch(), kLargestOffset);
  const bool restart =
      stream.connected && (!running_ || resync_ || stream.first_epoch != first_epoch_);
  if (!restart && !running_) return last_play_;
  const Duration elapsed =
      restart ? Duration{0} : std::max(local - last_.time_since_epoch(), Duration{0});
  last_ = LocalTime(restart ? local : std::max(local, last_.time_since_epoch()));
  if (stream.connected) {
    running_ = true;
    resync_ = false;
    first_epoch_ = stream.first_epoch;
    const Duration offset = clampTo(stream.clock_offset, kLargestOffset / 2) -
                            clampTo(stream.pipeline_latency, kLongestDelay);
    const Duration delay = std::clamp(stream.playout_delay_target, Duration{0}, kLongestDelay);
    // Without a force the budget exceeds any distance between two offsets.
    Duration budget = in_contact && !restart ? elapsed / kRateDivisor : Duration::max();
    approach(offset_, offset, budget);
    approach(delay_, delay, budget);
  }
  MediaTime play(last_.time_since_epoch() + offset_ - delay_);
  if (!restart && (user.paused || play < last_play_)) {
    // Hold play time. The delay becomes the present lag, and its slew starts there.
    delay_ = last_.time_since_epoch() + offset_ - last_play_.time_since_epoch();
    play = last_play_;
  }
  last_play_ = play;
  return play;
}

}  // namespace hapticast::client
