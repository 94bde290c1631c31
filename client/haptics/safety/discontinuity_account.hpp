// SPDX-License-Identifier: MIT
// Energy account of the discontinuities: it bounds the energy that a scene which does not continue
// puts into the hand. A spring that appears, grows or stiffens under a pressing hand has energy
// that the hand did not spend. The account pays for that energy. What it cannot pay, the chain does
// not render. So in any time t all discontinuities together give at most 3 mJ + 1.5 mW t.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <algorithm>

#include "common/time.hpp"

namespace hapticast::client {

/// The account of one safety chain.
class DiscontinuityAccount {
 public:
  /// Largest content, and the content at the start. Chosen: it gives an Omni in a hand of 150 g at
  /// most 175 mm/s. The passivity observer tolerates the same energy.
  static constexpr double kMost_mJ = 3.0;
  /// Refill, mW. Chosen: a clip that a user seeks in every 5 s keeps its force.
  static constexpr double kRefill_mW = 1.5;

  /// Refills the account for one tick.
  void refill() noexcept { content_mJ_ = std::min(content_mJ_ + kRefill_mW * kTick_s, kMost_mJ); }
  /// Withdraws `energy_mJ`, or the whole content if the content is smaller. Returns the energy that
  /// was withdrawn. Withdraws nothing if `energy_mJ` is not above 0.
  double pay(double energy_mJ) noexcept {
    const double paid_mJ = energy_mJ > 0.0 ? std::min(energy_mJ, content_mJ_) : 0.0;
    content_mJ_ -= paid_mJ;
    return paid_mJ;
  }
  [[nodiscard]] double content_mJ() const noexcept { return content_mJ_; }

 private:
  double content_mJ_ = kMost_mJ;
};

}  // namespace hapticast::client
