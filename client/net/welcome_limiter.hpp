// SPDX-License-Identifier: MIT
// Rate limit of the welcomes after the first one of a session. Each one ends the contact and opens
// sockets, so a server must not send many. Thread: any.
#pragma once

#include <cstdint>

#include "common/rate_limiter.hpp"

namespace hapticast::client {

/// Number of welcomes at once. Chosen: an edge changes its origin after seconds without frames.
inline constexpr std::int64_t kWelcomeBurst = 3;
/// Returns the limit: kWelcomeBurst welcomes at once, and one a second.
inline RateLimiter makeWelcomeLimiter() { return {kWelcomeBurst, std::chrono::seconds(1)}; }

}  // namespace hapticast::client
