// SPDX-License-Identifier: MIT
// Controls of the window: the panel beside the video, and the keys.
// Thread: main.
#pragma once

#include <imgui.h>

#include <string>

#include "client/view/force_history.hpp"
#include "client/view/window/relief.hpp"
#include "client/view/window/status.hpp"

namespace hapticast::client {

/// State of the panel.
struct PanelState {
  bool help = false;
  bool outline = false;
  ReliefLook relief = ReliefLook::kNone;
  double friction = 0.5;      ///< value of the control; in use once the user overrides the author's
  std::string note;           ///< message of the window, such as the name of a saved picture
  double picture_off_ms = 0;  ///< time of the shown picture minus time of the rendered frame
};

/// Processes a key. Returns true if the key has a function (list: helpText()).
bool pressKey(int sdl_key, UiState& ui_state, PanelState& state);

/// Draws the panel at `corner` with `size`. Its controls change `ui_state.user`.
void showPanel(const ImVec2& corner, const ImVec2& size, const TickWatch& ticks,
               const ForceHistory& history, UiState& ui_state, PanelState& state);

/// Draws the list of keys, in the middle of the area `room`.
void showHelp(const ImVec2& room, bool& open);

}  // namespace hapticast::client
