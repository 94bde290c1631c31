// SPDX-License-Identifier: MIT
// One of the two doors through which the loop is told what to do: what the user asks for.
#pragma once

#include <cstdint>
#include <optional>

#include "client/haptics/contact/surface_kind.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast::client {

/// The app writes it, the loop reads the latest value. A plain value that owns nothing. Whatever is
/// in it, the force changes without a step and stays within the chain's limits.
struct UserControls {
  /// The frame stands still and stays to be explored. Where it ends, the loop rejoins the stream as
  /// if it were a new one: frames from before are void, and the force fades in from zero.
  bool paused = false;
  /// A new value lets the force return, faded in, after a lost device has come back or trust
  /// in the stream was lost.
  std::uint32_t rearm = 0;
  /// Which of the two forces are felt. A surface that comes back fades in as a new one does.
  bool static_on = true;
  bool dynamic_on = true;
  /// Of the stiffness that author and profile ask for, 0.1..3; beyond --stiffness-limit it does
  /// nothing.
  double stiffness_factor = 1.0;
  double force_factor = 1.0;                      ///< of both forces, 0..1
  std::optional<double> friction = std::nullopt;  ///< 0..1, instead of the author's
  std::optional<Method> method = std::nullopt;    ///< instead of the one of the start
  std::optional<SurfaceKind> surface = std::nullopt;
};

}  // namespace hapticast::client
