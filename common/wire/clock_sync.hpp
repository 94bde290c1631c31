// SPDX-License-Identifier: MIT
// Offset between the server's media clock and the local clock from four-timestamp pings. Pure:
// times are arguments. Thread: one (the client's network thread).
#pragma once

#include <deque>

#include "common/time.hpp"

namespace hapticast {

class ClockSync {
 public:
  static constexpr std::size_t kBurst = 8;    ///< pings a client sends at once when it connects
  static constexpr std::size_t kNeeded = 5;   ///< pings before the offset is handed out
  static constexpr std::size_t kWindow = 64;  ///< pings remembered
  static constexpr double kMaxDrift = 5e-4;   ///< rate at which the offset handed out may change

  /// Forgets everything: a new connection.
  void reset() { *this = ClockSync(); }

  /// Ping sent at t0 and answer received at t3 (local), received and answered by the server at t1,
  /// t2 (media). Impossible samples (negative round trip, time running backwards) are ignored.
  void add(LocalTime t0, MediaTime t1, MediaTime t2, LocalTime t3);

  /// Enough pings were answered to hand out an offset.
  [[nodiscard]] bool ready() const { return samples_.size() >= kNeeded; }

  /// Media clock - local clock now. From the first call after ready() on it changes by at most
  /// kMaxDrift of the local time passed. Requires ready(); `now` does not run backwards.
  [[nodiscard]] Duration offset(LocalTime now);

  /// How far the offset last handed out may be off: half of the round trips the estimate was made
  /// from, and what the limited rate keeps it behind the estimate. Requires ready().
  [[nodiscard]] Duration errorBound() const;

 private:
  struct Sample {
    LocalTime time;  // middle of the ping
    Duration offset;
    Duration round_trip;
  };
  struct Line {  // offset = base + value + slope * (time - origin)
    LocalTime origin;
    Duration base{0};
    double value_ns = 0.0;
    double slope = 0.0;
    Duration error{0};
  };
  void fit();

  std::deque<Sample> samples_;  // newest last
  Line line_;
  bool handed_out_ = false;
  LocalTime last_{};
  Duration offset_{0};
  Duration behind_{0};  // how far offset_ is from the estimate
};

}  // namespace hapticast
