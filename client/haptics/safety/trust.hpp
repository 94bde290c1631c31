// SPDX-License-Identifier: MIT
// Trust in a stream: a counter of the ticks in which the stream caused a safety action. The count
// decays with time. The force ends when the count reaches a threshold. Without the counter, a
// stream could shake a hand without end, within the limits of the other steps.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/safety/safety_action.hpp"

namespace hapticast::client {

/// The counter of one stream.
class Trust {
 public:
  /// The safety actions that count. The selection was measured (client/haptics/safety/README.md,
  /// "Trust"): a stream causes these actions, and a hand cannot cause them. A jump counts only if
  /// the stream caused it. The other actions also occur with honest streams. A hand reaches the
  /// peak, a cut of the video disarms, an author requests stiff walls, and a late device makes a
  /// contact generate energy.
  static constexpr std::array<SafetyAction, 5> kCounted = {
      SafetyAction::kImplausible, SafetyAction::kTank, SafetyAction::kSlew,
      SafetyAction::kSurfaceSpeed, SafetyAction::kJump};

  /// Threshold of the count, in ticks. The value is a choice: far above all honest streams, and
  /// below most streams that shake a hand without end.
  ///
  /// The counts were measured. Honest streams and hands in stiff walls stay below 130. Some shaking
  /// streams stay below the threshold as well, so the chain only limits their force.
  static constexpr double kMost_ticks = 200.0;

  /// Cost of a jump of the scene under a force, in ticks. Each jump ends a force and lets another
  /// one fade in, and this transfers energy into the hand. Chosen: a clip that starts again every
  /// second keeps its trust, and one that starts again every 0.3 s loses it within 1.2 s.
  static constexpr double kJumpCost_ticks = 70.0;

  /// Jumps within this many ticks count as one. Chosen: a surface that moves too fast jumps in
  /// every tick.
  static constexpr int kJumpPause_ticks = 100;

  /// Adds one tick. `safety_actions` has one bit for each safety action of the tick. `scene_jumped`
  /// is true if the scene jumped while a force acted.
  void add(std::uint32_t safety_actions, bool scene_jumped = false) noexcept;
  /// Returns true if the count has reached the threshold.
  [[nodiscard]] bool lost() const noexcept { return score() >= kMost_ticks; }
  /// Returns the number of counted ticks. Each tick's share decays with a time constant of 2 s.
  [[nodiscard]] double score() const noexcept { return ticks_; }
  /// Returns the safety action that contributed most to the count.
  [[nodiscard]] SafetyAction findMostFrequent() const noexcept;
  /// Resets the count to 0. SafetyChain::rearm() calls it after a loss of trust.
  void renew() noexcept { *this = Trust(); }

 private:
  /// Time constant of the count's decay: 2 s.
  static constexpr double kMemory_ticks = 2000.0;
  double ticks_ = 0.0;
  int since_jump_ticks_ = kJumpPause_ticks;
  std::array<double, kCounted.size()> of_each_{};
};

}  // namespace hapticast::client
