// SPDX-License-Identifier: MIT
// The two times of the system, as types that do not mix, and the injectable local clock.
#pragma once

#include <chrono>
#include <cstdint>

namespace hapticast {

using Duration = std::chrono::nanoseconds;

/// Time on the server's media clock: capture time of a frame, steady, 0 when the server starts.
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

/// Seconds since the clock's zero.
template <class Clock>
constexpr double toSeconds(std::chrono::time_point<Clock, Duration> time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
constexpr double toSeconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}
/// Requires |seconds| < 9e9 (the range of 64-bit nanoseconds).
constexpr Duration fromSeconds(double seconds) {
  return Duration(static_cast<std::int64_t>(seconds * 1e9));
}
constexpr MediaTime mediaTime(double seconds) { return MediaTime(fromSeconds(seconds)); }
constexpr LocalTime localTime(double seconds) { return LocalTime(fromSeconds(seconds)); }

/// Where the rest of the program asks for the local time, so that tests can drive it by hand.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Thread: any.
  [[nodiscard]] virtual LocalTime now() const noexcept = 0;
};

/// CLOCK_MONOTONIC.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] LocalTime now() const noexcept override {
    return LocalTime(
        std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
  }
};

/// The clock that frames are stamped with: this machine's own, or one that follows an origin's on
/// another machine.
class MediaClock {
 public:
  virtual ~MediaClock() = default;
  /// Thread: any.
  [[nodiscard]] virtual MediaTime now() const noexcept = 0;
};

/// Media time is the local time since the clock was made.
class LocalMediaClock final : public MediaClock {
 public:
  /// `clock` outlives it.
  explicit LocalMediaClock(const Clock& clock) : clock_(clock), zero_(clock.now()) {}
  [[nodiscard]] MediaTime now() const noexcept override { return MediaTime(clock_.now() - zero_); }
  [[nodiscard]] LocalTime zero() const noexcept { return zero_; }

 private:
  const Clock& clock_;
  LocalTime zero_;
};

}  // namespace hapticast
