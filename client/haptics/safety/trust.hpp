// SPDX-License-Identifier: MIT
// Trust in a stream: a leaky counter of safety actions due to the stream. A limit alone would let a
// stream shake a hand for ever. The counter ends the force if the limits have to act all the time.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/safety/safety_action.hpp"

namespace hapticast::client {

class Trust {
 public:
  /// The actions that count. Measured (client/haptics/README.md, "Trust"): a stream causes these
  /// and a hand cannot. Other actions have honest causes: a hand reaches the peak, a cut disarms,
  /// an author requests stiff walls, and a late device makes a contact generate energy.
  static constexpr std::array<SafetyAction, 4> kCounted = {SafetyAction::kImplausible,
                                                           SafetyAction::kTank, SafetyAction::kSlew,
                                                           SafetyAction::kSurfaceSpeed};

  /// Threshold in ticks. Measured: honest streams reach at most 44 (a bouncing ball costs 14 ticks
  /// an impact, and the tank), 64 in the thesis's method. Chosen: far above them, and below most
  /// lies that shake without end. The gentlest of those lies reaches 198 and is only limited. A
  /// drum can strike seven times a second before trust is lost.
  static constexpr double kMost_ticks = 200.0;

  /// Adds a tick: one bit for each safety action.
  void add(std::uint32_t interferences) noexcept;
  /// Returns true if the score has reached the threshold.
  [[nodiscard]] bool lost() const noexcept { return score() >= kMost_ticks; }
  /// Number of counted ticks, with a decay of 2 s.
  [[nodiscard]] double score() const noexcept { return ticks_; }
  /// The counted action with the largest share.
  [[nodiscard]] SafetyAction mostly() const noexcept;
  /// Restores full trust, on request of the user.
  void renew() noexcept { *this = Trust(); }

 private:
  /// Decay of the score: 2 s.
  static constexpr double kMemory_ticks = 2000.0;
  double ticks_ = 0.0;
  std::array<double, kCounted.size()> of_each_{};
};

}  // namespace hapticast::client
