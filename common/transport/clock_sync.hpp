// SPDX-License-Identifier: MIT
// Clock synchronisation by pings with four timestamps, as in NTP. It estimates the offset: media
// clock minus local clock. The pings with the shortest delays determine the offset. Lower convex
// hulls determine the drift (Moon, Skelly and Towsley 1999). Callers pass all times as arguments.
// Thread: one (the client's network thread).
#pragma once

#include <deque>

#include "common/time.hpp"

namespace hapticast {

/// Estimates the clock offset of one connection.
class ClockSync {
 public:
  static constexpr std::size_t kBurst = 16;  ///< number of quick pings at the start of a connection
  static constexpr std::size_t kNeeded = 5;  ///< number of answered pings before the first offset
  /// Number of stored pings. The value is a choice: with fewer pings the estimated drift would be
  /// mostly jitter.
  static constexpr std::size_t kWindow = 256;
  static constexpr double kMaxDrift = 5e-4;  ///< largest rate of change of the offset

  /// Deletes all state, for a new connection.
  void reset() { *this = ClockSync(); }

  /// Adds an answered ping. The client sent it at t0 and received the answer at t3 (local time).
  /// The server received it at t1 and answered it at t2 (media time). A ping with impossible times
  /// is ignored (negative round trip, decreasing time).
  void add(LocalTime t0, MediaTime t1, MediaTime t2, LocalTime t3);

  /// Returns true if enough pings were answered for an offset.
  [[nodiscard]] bool ready() const { return answered_ >= kNeeded; }

  /// Returns media clock minus local clock at `now`. Requires ready(), and `now` must not decrease.
  ///
  /// After the first call the result changes by at most kMaxDrift of the elapsed local time. It
  /// changes faster only in two cases: the quickest pings exclude the old value, or better pings
  /// improve the estimate.
  [[nodiscard]] Duration offset(LocalTime now);

  /// Returns the largest possible error of the last returned offset. It is half of the quickest
  /// round trip, plus the remaining distance of that offset from the estimate. The quickest request
  /// and the quickest answer may belong to two different pings. Requires ready().
  [[nodiscard]] Duration errorBound() const;

 private:
  /// Two measurements of media minus local clock by one ping. The request yields `there`, which is
  /// too large by the request's delay. The answer yields `back`, which is too small by the answer's
  /// delay.
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
  [[nodiscard]] Line fitLine() const;

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
