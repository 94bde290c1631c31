// SPDX-License-Identifier: MIT
// Survives the loss of the X display or of the window. Xlib would otherwise end the process at
// once, with a force on the hand.
// Thread: main.
#pragma once

#include <SDL.h>

namespace hapticast::client {

/// Replaces Xlib's handlers: the loss of the display, or of `window`, is only recorded. Call it for
/// every new window. Does nothing without X.
void surviveDisplay(SDL_Window& window);

/// Processes an event that may report the loss.
void handleDisplayEvents(const SDL_Event& event);

/// Returns true if the window of the last surviveDisplay() is lost. Then no SDL video function is
/// allowed any more, not even its shutdown.
[[nodiscard]] bool displayIsLost();

}  // namespace hapticast::client
