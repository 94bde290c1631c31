// SPDX-License-Identifier: MIT
// Input of the loop from the user. The other input is StreamTiming.
// Thread: main (writer), loop (reader of the latest value).
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast::client {

// The surface models by name (--surface). client/haptics/README.md, section 2, compares them.

enum class SurfaceKind : std::uint8_t {
  kPerturbed,  ///< Eq. 3 divided by k, as printed
  kNormal,     ///< distance to the tangent plane, d / (1 + |g|²) along M
  kProxy,      ///< god-object proxy (proxy_surface.hpp); the only model with a state
};

/// Requests of the user, without ownership. Whatever the values, the force changes without a step
/// and stays within the limits of the safety chain.
struct UserControls {
  /// Holds the current frame for exploration. After the pause the loop joins the stream like a new
  /// one: earlier frames are void, and the force fades in from zero.
  bool paused = false;
  /// A new value re-arms the force after the return of a lost device, a loss of trust, or at an
  /// unconfirmed device. The force fades in.
  std::uint32_t rearm = 0;
  /// Enables each of the two forces. A re-enabled surface fades in like a new one.
  bool static_on = true;
  bool dynamic_on = true;
  /// Factor of the stiffness of author and profile, 0.1..3. The result stays within
  /// --stiffness-limit.
  double stiffness_factor = 1.0;
  double force_factor = 1.0;                      ///< factor of both forces, 0..1
  std::optional<double> friction = std::nullopt;  ///< 0..1; overrides the author's friction
  std::optional<Method> method = std::nullopt;    ///< overrides the method of the start
  std::optional<SurfaceKind> surface = std::nullopt;
};

// Target of a pointing device. The window writes it, a device that follows the pointer (mouse)
// reads it.
// Thread: any; LatestValue carries it between threads.

/// A target for the HIP, without ownership.
struct PointerTarget {
  bool known = false;               ///< false until the pointer was over the picture
  Vec3 position_mm = Vec3::Zero();  ///< nominal frame
};

}  // namespace hapticast::client
