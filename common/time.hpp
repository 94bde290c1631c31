// SPDX-License-Identifier: MIT
// Time types: media time and local time do not mix, and the local clock can be replaced in tests.
// Thread: any.
#pragma once

#include <chrono>
#include <cstdint>

namespace hapticast {

using Duration = std::chrono::nanoseconds;

/// Time of the server's media clock: capture time of a frame, steady, 0 at the server's start.
struct MediaClockTag {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<MediaClockTag>;
  static constexpr bool is_steady = true;
};
/// Time on this machine's steady clock.
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
/// Converts seconds. Requires |seconds| < 9e9 (the range of 64-bit nanoseconds).
constexpr Duration fromSeconds(double seconds) {
  return Duration(static_cast<std::int64_t>(seconds * 1e9));
}
constexpr MediaTime mediaTime(double seconds) { return MediaTime(fromSeconds(seconds)); }
constexpr LocalTime localTime(double seconds) { return LocalTime(fromSeconds(seconds)); }

/// Source of local time for the program; tests set it by hand.
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

/// Source of media time, for stamping frames: this machine's own, or a clock that follows an origin
/// on another machine.
class MediaClock {
 public:
  virtual ~MediaClock() = default;
  /// Thread: any.
  [[nodiscard]] virtual MediaTime now() const noexcept = 0;
};

/// Media clock of this machine: local time since the construction.
class LocalMediaClock final : public MediaClock {
 public:
  /// `clock` must outlive it.
  explicit LocalMediaClock(const Clock& clock) : clock_(clock), zero_(clock.now()) {}
  [[nodiscard]] MediaTime now() const noexcept override { return MediaTime(clock_.now() - zero_); }
  [[nodiscard]] LocalTime zero() const noexcept { return zero_; }

 private:
  const Clock& clock_;
  LocalTime zero_;
};

// Period of the haptic loop: 1 kHz, the usual rate for the haptic rendering of stiff surfaces.
// Thread: any.

inline constexpr Duration kTickPeriod{1'000'000};
inline constexpr double kTick_s = 1e-3;  ///< kTickPeriod in seconds
static_assert(fromSeconds(kTick_s) == kTickPeriod);

}  // namespace hapticast
