// SPDX-License-Identifier: MIT
// Handles the loss of the X display or of the window. Without these handlers Xlib would end the
// process at once, while a force acts on the hand.
// Thread: main.
#pragma once

#include <SDL.h>

namespace hapticast::client {

/// Replaces Xlib's error handlers. The new handlers only record that the display or `window` is
/// lost. Call it for every new window. It does nothing if the window system is not X.
void surviveDisplay(SDL_Window& window);

/// Processes `event`. If it reports that the display has removed the window, displayIsLost()
/// returns true from then on.
void handleDisplayEvents(const SDL_Event& event);

/// Returns true if the window of the last surviveDisplay() is lost. Then the caller must not call
/// any video function of SDL again, not even its shutdown.
[[nodiscard]] bool displayIsLost();

}  // namespace hapticast::client
