// SPDX-License-Identifier: MIT
// The force of the last minute, decimated for a plot. Each point has the peaks of its ticks.
// Thread: one.
#pragma once

#include <cstddef>
#include <deque>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// Largest magnitudes of successive ticks.
struct ForcePoint {
  double time_s = 0.0;  ///< begin, since the first tick of the run
  double force_N = 0.0;
  double static_force_N = 0.0;
  double dynamic_force_N = 0.0;
  double penetration_mm = 0.0;
  bool contact = false;  ///< true if any tick was in contact
};

/// Bounded queue of points.
class ForceHistory {
 public:
  /// Chosen: 5 ms per point, for one minute. A plot of 900 px shows no more. A full history
  /// occupies 576 kB.
  static constexpr std::size_t kTicksPerPoint = 5;
  static constexpr std::size_t kSeconds = 60;
  static constexpr std::size_t kMaxPoints = kSeconds * 1000 / kTicksPerPoint;

  /// Adds a tick of the 1 kHz loop, and drops points older than a minute.
  void add(const TickReport& report);
  /// Oldest first, at most kMaxPoints.
  [[nodiscard]] const std::deque<ForcePoint>& points() const { return points_; }

 private:
  std::deque<ForcePoint> points_;
  std::size_t ticks_in_last_ = 0;
};

}  // namespace hapticast::client
