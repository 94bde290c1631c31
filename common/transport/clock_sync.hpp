// SPDX-License-Identifier: MIT
// Offset between the server's media clock and the local clock from four-timestamp pings. Pure:
// times are arguments. Thread: one (the client's network thread).
#pragma once

#include <deque>

#include "common/time.hpp"

namespace hapticast {

class ClockSync {
 public:
  static constexpr std::size_t kBurst = 16;  ///< pings a client sends at once when it connects
  static constexpr std::size_t kNeeded = 5;  ///< pings before the offset is handed out
  /// Pings remembered; chosen: the slope over less of them is mostly jitter.
  static constexpr std::size_t kWindow = 256;
  static constexpr double kMaxDrift = 5e-4;  ///< rate at which the offset handed out may change

  /// Forgets everything: a new connection.
  void reset() { *this = ClockSync(); }

  /// Ping sent at t0 and answer received at t3 (local), received and answered by the server at t1,
  /// t2 (media). Impossible samples (negative round trip, time running backwards) are ignored.
  void add(LocalTime t0, MediaTime t1, MediaTime t2, LocalTime t3);

  /// Enough pings were answered to hand out an offset.
  [[nodiscard]] bool ready() const { return answered_ >= kNeeded; }

  /// Media clock - local clock now. From the first call after ready() on it changes by at most
  /// kMaxDrift of the local time passed, but for what the quickest ways there and back rule out and
  /// for what better pings make more exact.
  /// Requires ready(); `now` does not run backwards.
  [[nodiscard]] Duration offset(LocalTime now);

  /// How far the offset last handed out may be off: half of the quickest way there and the quickest
  /// way back, and what the limited rate keeps it behind the estimate. Requires ready().
  [[nodiscard]] Duration errorBound() const;

 private:
  /// One ping: media - local clock as each way shows it, too large by what it took to go there, too
  /// small by what it took to come back.
  struct Sample {
    LocalTime time;  // its middle
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
  Duration error_{0};   // of the estimate, when it was handed out last
  Duration behind_{0};  // how far offset_ is from the estimate
};

}  // namespace hapticast
