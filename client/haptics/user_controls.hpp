// SPDX-License-Identifier: MIT
// One of the two doors through which the loop is told what to do: what the user asks for.
#pragma once

#include <cstdint>

namespace hapticast::client {

/// The app writes it, the loop reads the latest value. A plain value that owns nothing.
struct UserControls {
  /// The frame stands still and stays to be explored. Where it ends, the loop rejoins the stream as
  /// if it were a new one: frames from before are void, and the force fades in from zero.
  bool paused = false;
  /// A new value lets the force return, faded in, after a lost device has come back or trust
  /// in the stream was lost. So far only --rearm writes one: there is no key or button for it.
  std::uint32_t rearm = 0;
};

}  // namespace hapticast::client
