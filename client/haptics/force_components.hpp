// SPDX-License-Identifier: MIT
// Splits the rendered force into a sustained and a transient component. Outputs with less bandwidth
// than a haptic device (rumble and sound) use the components. A one-pole low-pass filter with a
// time constant of 50 ms separates them. A peak hold with the same time constant makes a short
// transient last longer.
// Thread: any, one at a time.
#pragma once

#include <algorithm>

#include "client/haptics/tick_report.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// The two components of the force in one tick.
struct ForceComponents {
  double sustained_N = 0.0;  ///< rendered share of the static force
  /// The larger of two values, after the peak hold: the fast change of the force (such as the begin
  /// of a contact), and the rendered share of the dynamic force.
  double transient_N = 0.0;
};

/// Computes the two components tick by tick. The object stores the state of the low-pass and of the
/// peak hold.
class TransientDetector {
 public:
  /// Returns the components of the force in `report`. Call it once for every tick, in order.
  ForceComponents next(const TickReport& report) noexcept {
    const double rendered_N = report.force_N.norm();
    if (!(rendered_N > kNothing_N)) {
      *this = {};
      return {};
    }
    // The report has the shares before the limits of the safety chain. Scale them to the force
    // after the chain.
    const double requested_N = (report.static_force_N + report.dynamic_force_N).norm();
    const double share = std::min(1.0, rendered_N / std::max(requested_N, kNothing_N));
    slow_N_ += (kTick_s / kSudden_s) * (report.force_N - slow_N_);
    const double sudden_N = (report.force_N - slow_N_).norm();
    const double transient_N = std::max(sudden_N, share * report.dynamic_force_N.norm());
    transient_N_ = std::max(transient_N, (1.0 - kTick_s / kSudden_s) * transient_N_);
    return {.sustained_N = share * report.static_force_N.norm(), .transient_N = transient_N_};
  }

 private:
  // The value is a choice: a smaller force counts as no touch.
  static constexpr double kNothing_N = 0.01;
  // The value is a choice. A motor needs this long to run up, although an impact lasts only 15 ms.
  // An event loop of 10 ms also reads the peak in that time.
  static constexpr double kSudden_s = 0.05;
  Vec3 slow_N_ = Vec3::Zero();
  double transient_N_ = 0.0;
};

}  // namespace hapticast::client
