// SPDX-License-Identifier: MIT
#include "client/view/force_history.hpp"

#include <algorithm>

namespace hapticast::client {

void ForceHistory::add(const TickReport& report) {
  if (ticks_in_last_ == 0) {
    if (points_.size() == kMaxPoints) points_.pop_front();
    points_.push_back({toSeconds(report.time), 0.0, 0.0, 0.0, 0.0, false});
  }
  ForcePoint& point = points_.back();
  point.force_N = std::max(point.force_N, report.force_N.norm());
  point.static_force_N = std::max(point.static_force_N, report.static_force_N.norm());
  point.dynamic_force_N = std::max(point.dynamic_force_N, report.dynamic_force_N.norm());
  point.penetration_mm = std::max(point.penetration_mm, report.penetration_mm);
  point.contact = point.contact || report.contact;
  ticks_in_last_ = (ticks_in_last_ + 1) % kTicksPerPoint;
}

}  // namespace hapticast::client
