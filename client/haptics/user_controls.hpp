// SPDX-License-Identifier: MIT
// Controls of the user. The main thread passes them to the loop. (The network thread passes
// StreamTiming.)
// Thread: main (writer), loop (reader of the latest value).
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast::client {

// The surface models. Each computes the displacement from the HIP to the surface in its own way
// (--surface). client/haptics/README.md, section 2, compares them.

enum class SurfaceKind : std::uint8_t {
  kPerturbed,  ///< Eq. 3 of the thesis, divided by its stiffness k
  kNormal,     ///< shortest vector to the tangent plane of the surface
  kProxy,      ///< god-object proxy (proxy_surface.hpp); only this model has a state
};

/// Requests of the user. The struct owns no memory. Whatever the values are, the force changes
/// without a step, and it remains within the limits of the safety chain.
struct UserControls {
  std::uint64_t number = 0;  ///< counts the changes of one run, from 1; 0: the initial value
  /// True: play time stops, so that the user can explore the current frame. After the pause the
  /// loop continues with the newest frames, as at a new connection. It drops the earlier frames,
  /// and the force fades in from zero.
  bool paused = false;
  /// A new value re-arms the force, which then fades in. Re-arming is necessary after the return of
  /// a lost device, after a loss of trust, and for a device that the user has not confirmed.
  std::uint32_t rearm = 0;
  /// A new value re-arms the force as well. The client does it by itself (--rearm), so it does not
  /// end a safety state that waits for the user.
  std::uint32_t rearm_by_itself = 0;
  /// A new value ramps the force to zero at once. It remains zero until `rearm` changes.
  std::uint32_t stop = 0;
  /// Enable the static and the dynamic force. If the static force is enabled again, it fades in
  /// from zero.
  bool static_on = true;
  bool dynamic_on = true;
  /// Factor of the stiffness that the author or the profile states, 0.1..3. The product remains
  /// within --stiffness-limit.
  double stiffness_factor = 1.0;
  double force_factor = 1.0;  ///< factor of both forces, 0..1
  /// Friction coefficient, 0..1; replaces the author's friction.
  std::optional<double> friction = std::nullopt;
  /// Mass of the object, kg; replaces the author's mass. After a change the force fades in from
  /// zero.
  std::optional<double> mass_kg = std::nullopt;
  std::optional<Method> method = std::nullopt;  ///< replaces the method of --method
  std::optional<SurfaceKind> surface = std::nullopt;
  bool operator==(const UserControls&) const = default;
};

/// The target position of a pointing device for the HIP. The window writes it. A device that
/// follows the pointer (a mouse) reads it. The struct owns no memory. Thread: any; LatestValue
/// carries it between threads.
struct PointerTarget {
  bool known = false;  ///< false until the pointer was over the picture for the first time
  Vec3 position_mm = Vec3::Zero();  ///< nominal frame
  /// Nominal z of the start position. It is also the largest z that the user can set.
  double start_z_mm = 0.0;
};

}  // namespace hapticast::client
