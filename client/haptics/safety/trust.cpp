// SPDX-License-Identifier: MIT
#include "client/haptics/safety/trust.hpp"

#include <algorithm>

namespace hapticast::client {

void Trust::add(std::uint32_t interferences) noexcept {
  constexpr double kKeep = 1.0 - 1.0 / kMemory_ticks;
  bool any = false;
  for (std::size_t i = 0; i < kCounted.size(); ++i) {
    const bool acted = (interferences & bit(kCounted[i])) != 0;
    any = any || acted;
    of_each_[i] = of_each_[i] * kKeep + (acted ? 1.0 : 0.0);
  }
  ticks_ = ticks_ * kKeep + (any ? 1.0 : 0.0);
}

SafetyAction Trust::mostly() const noexcept {
  const auto* const most = std::max_element(of_each_.data(), of_each_.data() + of_each_.size());
  return kCounted[static_cast<std::size_t>(most - of_each_.data())];
}

}  // namespace hapticast::client
