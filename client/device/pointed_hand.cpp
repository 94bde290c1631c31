// SPDX-License-Identifier: MIT
#include "client/device/pointed_hand.hpp"

#include <utility>

#include "common/time.hpp"

namespace hapticast::client {

namespace {

// Chosen: the hand follows its input within a tenth of a second.
constexpr double kFollow_1_s = 40.0;
// Chosen: the largest distance to the input, which limits the speed to 400 mm/s.
constexpr double kMostBehind_mm = 20.0;

}  // namespace

void PointedHand::moveTowards(const Vec3& wanted_mm) noexcept {
  if (!std::exchange(moves_, true)) goal_mm_ = tip_mm();
  Vec3 path_mm = wanted_mm - goal_mm_;
  if (path_mm.norm() > kMostBehind_mm) path_mm *= kMostBehind_mm / path_mm.norm();
  // Critically damped: no overshoot.
  velocity_mm_s_ +=
      kTick_s * (kFollow_1_s * kFollow_1_s * path_mm - 2.0 * kFollow_1_s * velocity_mm_s_);
  goal_mm_ += kTick_s * velocity_mm_s_;
  device_.setTarget(goal_mm_);
}

}  // namespace hapticast::client
