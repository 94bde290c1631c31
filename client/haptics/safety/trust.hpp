// SPDX-License-Identifier: MIT
// Whether a stream is still trusted: only as long as the chain has little to do about it. What is
// only limited may shake a hand for as long as it likes; what has to be limited all the time ends.
// Real-time room.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/safety/safety_action.hpp"

namespace hapticast::client {

class Trust {
 public:
  /// What counts, measured (client/haptics/README.md): what a stream does and a hand cannot. A hand
  /// reaches the peak, a cut leaves it unarmed, an author asks for stiff walls, a device that
  /// answers late makes a contact give energy: these do not count.
  static constexpr std::array<SafetyAction, 4> kCounted = {SafetyAction::kImplausible,
                                                           SafetyAction::kTank, SafetyAction::kSlew,
                                                           SafetyAction::kSurfaceSpeed};

  /// Measured: honest streams come to at most 44 (a ball that bounces: 14 ticks an impact, and the
  /// tank), in the thesis's method to 64. Chosen: far above them and below most lies that shake
  /// without end; the gentlest of those, at 198, is only limited. A drum is struck seven times a
  /// second before it is distrusted.
  static constexpr double kMost_ticks = 200.0;

  /// What was done in a tick, a bit for each interference.
  void add(std::uint32_t interferences) noexcept;
  /// Too much of it in the last seconds.
  [[nodiscard]] bool lost() const noexcept { return score() >= kMost_ticks; }
  /// The ticks in which it was too much, forgotten within the memory.
  [[nodiscard]] double score() const noexcept { return ticks_; }
  /// What most of it was.
  [[nodiscard]] SafetyAction mostly() const noexcept;
  /// The user trusts it again.
  void renew() noexcept { *this = Trust(); }

 private:
  static constexpr double kMemory_ticks = 2000.0;
  double ticks_ = 0.0;
  std::array<double, kCounted.size()> of_each_{};
};

}  // namespace hapticast::client
