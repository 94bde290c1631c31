// SPDX-License-Identifier: MIT
#include "client/device/helper/program/force_gate.hpp"

#include <algorithm>
#include <chrono>

namespace hapticast::client {

namespace {
using std::chrono::milliseconds;
// Chosen: ten missed ticks. With the descent, zero is at the motors within 30 ms.
constexpr Duration kStaleHeartbeat = milliseconds(10);
constexpr double kDescent_s = 0.01;  // within the slew limits of all built-in profiles
constexpr double kReturn_s = 0.5;    // as after a silence of the device
constexpr double kLongestStep_s = 0.01;
}  // namespace

Vec3 ForceGate::computeForce_N(const DeviceCommand& command, bool alive, LocalTime now) noexcept {
  const double step_s = std::clamp(toSeconds(now - last_), 0.0, kLongestStep_s);
  last_ = now;
  const Duration age = now.time_since_epoch() - Duration(command.time_ns);
  const bool fresh = alive && age < kStaleHeartbeat;
  share_ = std::clamp(share_ + (fresh ? step_s / kReturn_s : -step_s / kDescent_s), 0.0, 1.0);
  Vec3 force_N(command.force_N[0], command.force_N[1], command.force_N[2]);
  if (!force_N.allFinite()) force_N = Vec3::Zero();
  reduces_ = share_ < 1.0 && force_N != Vec3::Zero();
  force_N *= share_;
  at_zero_ = force_N == Vec3::Zero();
  return force_N;
}

}  // namespace hapticast::client
