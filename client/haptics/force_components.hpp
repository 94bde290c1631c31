// SPDX-License-Identifier: MIT
// What of the felt force is a steady press and what is sudden: for whoever renders it on less than
// a haptic device, as rumble or as sound. Thread: any, one at a time.
#pragma once

#include <algorithm>

#include "client/haptics/tick_report.hpp"
#include "common/tick.hpp"

namespace hapticast::client {

struct ForceComponents {
  double sustained_N = 0.0;
  double transient_N = 0.0;  ///< dynamic force, touches, impacts; held for a moment
};

class TransientDetector {
 public:
  /// Sees every tick; what is felt in it.
  ForceComponents next(const TickReport& report) noexcept {
    const double rendered_N = report.force_N.norm();
    if (!(rendered_N > kNothing_N)) {
      *this = {};
      return {};
    }
    // The two shares are meant; what the chain let through of them is felt.
    const double requested_N = (report.static_force_N + report.dynamic_force_N).norm();
    const double share = std::min(1.0, rendered_N / std::max(requested_N, kNothing_N));
    slow_N_ += (kTick_s / kSudden_s) * (report.force_N - slow_N_);
    const double sudden_N = (report.force_N - slow_N_).norm();
    const double transient_N = std::max(sudden_N, share * report.dynamic_force_N.norm());
    transient_N_ = std::max(transient_N, (1.0 - kTick_s / kSudden_s) * transient_N_);
    return {.sustained_N = share * report.static_force_N.norm(), .transient_N = transient_N_};
  }

 private:
  // Chosen: less is no touch.
  static constexpr double kNothing_N = 0.01;
  // Chosen: a touch or an impact's 15 ms are held until a motor has turned up, and an event loop of
  // 10 ms has seen them.
  static constexpr double kSudden_s = 0.05;
  Vec3 slow_N_ = Vec3::Zero();
  double transient_N_ = 0.0;
};

}  // namespace hapticast::client
