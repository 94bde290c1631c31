// SPDX-License-Identifier: MIT
// Rate limit of the welcomes after the first one of a session. Each such welcome ends the contact
// and opens sockets, so a server must not send many of them. Thread: one for each object.
#pragma once

#include <algorithm>

#include "common/time.hpp"

namespace hapticast::client {

class WelcomeRateLimiter {
 public:
  /// Number of welcomes at once, and time between two further ones. The values are a choice: an
  /// edge changes its origin after seconds without frames.
  static constexpr int kBurst = 3;
  static constexpr Duration kPause = std::chrono::seconds(1);

  /// Registers a welcome at `now`. Returns false if the server sends them too often.
  [[nodiscard]] bool allow(LocalTime now) {
    until_ = std::max(until_, now) + kPause;
    return until_ - now <= kBurst * kPause;
  }

 private:
  LocalTime until_{};  // end of the pauses of all welcomes so far
};

}  // namespace hapticast::client
