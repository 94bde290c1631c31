// SPDX-License-Identifier: MIT
// The force of the last minute for a plot: a ring of points that keep the peaks of the ticks they
// stand for. Thread: one.
#pragma once

#include <cstddef>
#include <deque>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// The largest magnitudes of some ticks in a row.
struct ForcePoint {
  double time_s = 0.0;  ///< of the first of them, since the first tick of the run
  double force_N = 0.0;
  double static_force_N = 0.0;
  double dynamic_force_N = 0.0;
  double penetration_mm = 0.0;
  bool contact = false;  ///< in any of them
};

class ForceHistory {
 public:
  /// Chosen: 5 ms a point, and a minute of them. A plot 900 px wide shows no more, and they take
  /// 480 kB however long a run is.
  static constexpr std::size_t kTicksPerPoint = 5;
  static constexpr std::size_t kSeconds = 60;
  static constexpr std::size_t kMaxPoints = kSeconds * 1000 / kTicksPerPoint;

  /// Adds a tick of the 1 kHz loop; the point of a minute ago makes room.
  void add(const TickReport& report);
  /// Oldest first, at most kMaxPoints.
  [[nodiscard]] const std::deque<ForcePoint>& points() const { return points_; }

 private:
  std::deque<ForcePoint> points_;
  std::size_t ticks_in_last_ = 0;
};

}  // namespace hapticast::client
