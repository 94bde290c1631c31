// SPDX-License-Identifier: MIT
// What differs between Dear ImGui 1.86 (Debian 12) and 1.90 (Debian 13) stands here.
// Thread: main.
#pragma once

#include <SDL.h>
#include <imgui.h>
#if __has_include(<backends/imgui_impl_sdl2.h>)  // since 1.89.3
#include <backends/imgui_impl_sdl2.h>
#else
#include <backends/imgui_impl_sdl.h>
#endif

namespace hapticast::client {

/// Connects ImGui's events to the window. `renderer` draws it.
inline void connectGui(SDL_Window& window, [[maybe_unused]] SDL_Renderer& renderer) {
#if IMGUI_VERSION_NUM >= 18700
  ImGui_ImplSDL2_InitForSDLRenderer(&window, &renderer);
#else
  ImGui_ImplSDL2_InitForSDLRenderer(&window);
#endif
}

}  // namespace hapticast::client
