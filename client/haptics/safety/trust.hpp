// SPDX-License-Identifier: MIT
// Trust in a stream: two counters of the ticks in which the stream caused a safety action. One
// decays within 2 s, the other within 60 s. A third meter is the vibration dose of the last minute.
// The force ends when one of them reaches its threshold. Without them, a stream could shake a hand
// without end, within the limits of the other steps.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/safety/hand_limits.hpp"
#include "client/haptics/safety/safety_action.hpp"
#include "client/haptics/safety/vibration_dose.hpp"

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

  /// Threshold of the count, in ticks. The value is a choice: above the honest streams, and below
  /// most streams that shake a hand without end.
  ///
  /// Measured: honest streams stay below 70, but for a sphere that carries a firm hand at 250 mm/s,
  /// which reaches 200. Some shaking streams stay below: the chain only limits their force.
  static constexpr double kMost_ticks = 200.0;

  /// Threshold of the second count, whose memory is 60 s. Chosen: a jump of the scene under a force
  /// in every second reaches it within a minute, and a clip of 2 s never does.
  static constexpr double kMostLasting_ticks = 2500.0;

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
  /// Adds the motion of one tick to the vibration dose (VibrationDose::add).
  void addMotion(double surface_mm_s, double hip_mm_s) noexcept {
    vibration_.add(surface_mm_s, hip_mm_s);
  }
  /// Returns true if one of the counts or the vibration has reached its threshold.
  [[nodiscard]] bool lost() const noexcept {
    return score() >= kMost_ticks || lasting_ticks_ >= kMostLasting_ticks ||
           vibration_.rms_m_s2() >= kHandVibration_m_s2;
  }
  /// Returns the number of counted ticks. Each tick's share decays with a time constant of 2 s.
  [[nodiscard]] double score() const noexcept { return ticks_; }
  /// Returns the safety action that contributed most to the count.
  [[nodiscard]] SafetyAction findMostFrequent() const noexcept;
  /// Resets the count to 0. SafetyChain::rearm() calls it after a loss of trust.
  void renew() noexcept { *this = Trust(); }

 private:
  /// Time constant of the count's decay: 2 s.
  static constexpr double kMemory_ticks = 2000.0;
  /// Time constant of the second count's decay: 60 s.
  static constexpr double kLongMemory_ticks = 60'000.0;
  double ticks_ = 0.0;
  double lasting_ticks_ = 0.0;
  VibrationDose vibration_;
  int since_jump_ticks_ = kJumpPause_ticks;
  std::array<double, kCounted.size()> of_each_{};
};

}  // namespace hapticast::client
