// SPDX-License-Identifier: MIT
// Rate limit of the welcome messages after the first one of a session. Each welcome ends the
// contact and opens new sockets, so the client limits how many a server may send. Thread: any.
#pragma once

#include <cstdint>

#include "common/rate_limiter.hpp"

namespace hapticast::client {

/// Largest number of welcomes in a burst. Chosen: an edge sends a welcome only when it changes its
/// origin, which happens after seconds without frames.
inline constexpr std::int64_t kWelcomeBurst = 3;
/// Returns a limiter that permits kWelcomeBurst welcomes in a burst, and one per second on average.
inline RateLimiter makeWelcomeLimiter() { return {kWelcomeBurst, std::chrono::seconds(1)}; }

}  // namespace hapticast::client
