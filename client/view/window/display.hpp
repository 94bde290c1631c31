// SPDX-License-Identifier: MIT
// What becomes of the window when its display takes it away, or ends: Xlib would end the process
// there and then, with the force still on the hand. Thread: main.
#pragma once

#include <SDL.h>

namespace hapticast::client {

/// From now on the loss of the display, or of `window` alone, is only remembered. To be called
/// again for every window; where SDL draws on something else than X it does nothing.
void surviveDisplay(SDL_Window& window);

/// An event that may tell of it.
void handleDisplayEvents(const SDL_Event& event);

/// Whether that has happened to the window of the last call. SDL's video may not be used any more
/// then, not even to be ended.
[[nodiscard]] bool displayIsLost();

}  // namespace hapticast::client
