// SPDX-License-Identifier: MIT
#include "client/haptics/safety/trust.hpp"

#include <algorithm>

namespace hapticast::client {

void Trust::add(std::uint32_t safety_actions, bool scene_jumped) noexcept {
  constexpr double kKeep = 1.0 - 1.0 / kMemory_ticks;
  double most = 0.0;
  since_jump_ticks_ = std::min(since_jump_ticks_ + 1, kJumpPause_ticks);
  scene_jumped = scene_jumped && since_jump_ticks_ == kJumpPause_ticks;
  if (scene_jumped) since_jump_ticks_ = 0;
  for (std::size_t i = 0; i < kCounted.size(); ++i) {
    const bool jump = kCounted[i] == SafetyAction::kJump;
    const bool acted = jump ? scene_jumped : (safety_actions & bit(kCounted[i])) != 0;
    const double cost = !acted ? 0.0 : jump ? kJumpCost_ticks : 1.0;
    most = std::max(most, cost);
    of_each_[i] = of_each_[i] * kKeep + cost;
  }
  ticks_ = ticks_ * kKeep + most;
  lasting_ticks_ = lasting_ticks_ * (1.0 - 1.0 / kLongMemory_ticks) + most;
}

SafetyAction Trust::findMostFrequent() const noexcept {
  const auto* const most = std::max_element(of_each_.data(), of_each_.data() + of_each_.size());
  return kCounted[static_cast<std::size_t>(most - of_each_.data())];
}

}  // namespace hapticast::client
