// SPDX-License-Identifier: MIT
// The names of the surface models.
#pragma once

#include <cstdint>

namespace hapticast::client {

enum class SurfaceKind : std::uint8_t {
  kPerturbed,  ///< Eq. 3 over k, as printed
  kNormal,     ///< distance to the tangent plane, d / (1 + |g|²) along M
  kProxy,      ///< the surface point the HIP is tied to (proxy_surface.hpp): has a state
};

}  // namespace hapticast::client
