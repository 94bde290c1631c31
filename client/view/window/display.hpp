// SPDX-License-Identifier: MIT
// Handling of a lost X display or window. Without it Xlib would end the process at once, while a
// force acts on the hand.
// Thread: main.
#pragma once

#include <SDL.h>

namespace hapticast::client {

/// Replaces Xlib's error handlers. The new ones only record that the display or `window` is lost.
/// Call it for every new window. Without X it does nothing.
void surviveDisplay(SDL_Window& window);

/// Processes an SDL event. If it says that the display has removed the window, displayIsLost() is
/// true from then on.
void handleDisplayEvents(const SDL_Event& event);

/// Returns true if the window of the last surviveDisplay() is lost. Then the caller must not call
/// any video function of SDL again, not even its shutdown.
[[nodiscard]] bool displayIsLost();

}  // namespace hapticast::client
