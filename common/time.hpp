// SPDX-License-Identifier: MIT
// Types for times. Media time and local time are different types, so the compiler rejects a
// mixture. Tests can replace the local clock.
// Thread: any.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace hapticast {

using Duration = std::chrono::nanoseconds;

/// Clock type of media time: the server's steady clock, which is 0 at the server's start. A frame
/// has the media time of its capture.
struct MediaClockTag {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<MediaClockTag>;
  static constexpr bool is_steady = true;
};
/// Clock type of local time: this machine's steady clock.
struct LocalClockTag {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<LocalClockTag>;
  static constexpr bool is_steady = true;
};
using MediaTime = MediaClockTag::time_point;
using LocalTime = LocalClockTag::time_point;

/// Returns the seconds since the clock's zero.
template <class Clock>
constexpr double toSeconds(std::chrono::time_point<Clock, Duration> time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
constexpr double toSeconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}
/// Returns the duration of `seconds`. Requires |seconds| < 9e9 (the range of 64-bit nanoseconds).
constexpr Duration fromSeconds(double seconds) {
  return Duration(static_cast<std::int64_t>(seconds * 1e9));
}
constexpr MediaTime mediaTime(double seconds) { return MediaTime(fromSeconds(seconds)); }
constexpr LocalTime localTime(double seconds) { return LocalTime(fromSeconds(seconds)); }

/// Source of local time. Tests replace it by a clock that they set by hand.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Thread: any.
  [[nodiscard]] virtual LocalTime now() const noexcept = 0;
};

/// The system's steady clock (CLOCK_MONOTONIC).
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] LocalTime now() const noexcept override {
    return LocalTime(
        std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
  }
};

/// A clock that its owner sets. It never goes back. Thread: one.
class SetClock final : public Clock {
 public:
  [[nodiscard]] LocalTime now() const noexcept override { return now_; }
  /// Sets the time to `now`, unless it would go back.
  void set(LocalTime now) { now_ = std::max(now_, now); }

 private:
  LocalTime now_{LocalTime::min()};
};

/// Source of media time, for the times of frames. It is this machine's own clock, or a clock that
/// follows another machine.
class MediaClock {
 public:
  virtual ~MediaClock() = default;
  /// Thread: any.
  [[nodiscard]] virtual MediaTime now() const noexcept = 0;
  /// Returns the largest error of now() against the clock of the frames. It is 0 if this machine
  /// stamps the frames. Thread: any.
  [[nodiscard]] virtual Duration errorBound() const noexcept { return {}; }
};

/// Media clock of this machine.
class LocalMediaClock final : public MediaClock {
 public:
  /// Starts at `start`, which is now. `clock` must outlive this object.
  explicit LocalMediaClock(const Clock& clock, MediaTime start = {})
      : clock_(clock), zero_(clock.now() - start.time_since_epoch()) {}
  [[nodiscard]] MediaTime now() const noexcept override { return MediaTime(clock_.now() - zero_); }
  /// Returns the local time of the media time 0.
  [[nodiscard]] LocalTime zero() const noexcept { return zero_; }

 private:
  const Clock& clock_;
  LocalTime zero_;
};

/// Period of the haptic loop. Its rate is 1 kHz, which is usual for the haptic rendering of stiff
/// surfaces.
inline constexpr Duration kTickPeriod{1'000'000};
inline constexpr double kTick_s = 1e-3;  ///< kTickPeriod in seconds
static_assert(fromSeconds(kTick_s) == kTickPeriod);

}  // namespace hapticast
