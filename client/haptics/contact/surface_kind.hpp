// SPDX-License-Identifier: MIT
// The surface models by name (--surface). client/haptics/README.md, section 2, compares them.
#pragma once

#include <cstdint>

namespace hapticast::client {

enum class SurfaceKind : std::uint8_t {
  kPerturbed,  ///< Eq. 3 divided by k, as printed
  kNormal,     ///< distance to the tangent plane, d / (1 + |g|²) along M
  kProxy,      ///< god-object proxy (proxy_surface.hpp); the only model with a state
};

}  // namespace hapticast::client
