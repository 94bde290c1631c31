// SPDX-License-Identifier: MIT
// Clock synchronisation from four-timestamp pings, as in NTP: offset from the quickest ways, drift
// from lower convex hulls (Moon, Skelly and Towsley 1999).
// Estimates media clock minus local clock. Times are arguments. Thread: one (the client's network
// thread).
#pragma once

#include <deque>

#include "common/time.hpp"

namespace hapticast {

/// Estimate for one connection.
class ClockSync {
 public:
  static constexpr std::size_t kBurst = 16;  ///< pings at the start of a connection
  static constexpr std::size_t kNeeded = 5;  ///< pings before the first offset
  /// Stored pings; chosen: over fewer the slope is mostly jitter.
  static constexpr std::size_t kWindow = 256;
  static constexpr double kMaxDrift = 5e-4;  ///< largest rate of change of the offset

  /// Resets all state, for a new connection.
  void reset() { *this = ClockSync(); }

  /// Adds a ping: sent at t0 and its answer received at t3 (local), received and answered by the
  /// server at t1 and t2 (media). Ignores impossible samples (negative round trip, decreasing
  /// time).
  void add(LocalTime t0, MediaTime t1, MediaTime t2, LocalTime t3);

  /// Returns whether enough pings were answered for an offset.
  [[nodiscard]] bool ready() const { return answered_ >= kNeeded; }

  /// Returns media clock minus local clock at `now`. Requires ready(); `now` must not decrease.
  /// After the first call it changes by at most kMaxDrift of the elapsed local time. It changes
  /// faster only if the quickest ways exclude the old value, or if better pings improve the
  /// estimate.
  [[nodiscard]] Duration offset(LocalTime now);

  /// Returns the largest error of the last returned offset. It is half of the sum of the quickest
  /// ways there and back, plus the remaining distance to the estimate. Requires ready().
  [[nodiscard]] Duration errorBound() const;

 private:
  /// One ping: media minus local clock by each way. `there` is too large by the delay there, `back`
  /// too small by the delay back.
  struct Sample {
    LocalTime time;  // middle of the ping
    Duration there;
    Duration back;
  };
  struct Line {  // offset = base + value + slope * (time - origin)
    LocalTime origin;
    Duration base{0};
    double value_ns = 0.0;
    double slope = 0.0;
    Duration error{0};
  };
  void fit();
  [[nodiscard]] Line fitted() const;

  std::deque<Sample> samples_;  // newest last
  std::size_t answered_ = 0;
  Line line_;
  bool published_ = false;
  LocalTime last_{};
  Duration offset_{0};
  Duration error_{0};   // error of the estimate at the last offset()
  Duration behind_{0};  // distance of offset_ from the estimate
};

}  // namespace hapticast
