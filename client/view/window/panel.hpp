// SPDX-License-Identifier: MIT
// The controls of the window: the panel beside the video, the keys.
// Thread: main.
#pragma once

#include <imgui.h>

#include <string>

#include "client/view/force_history.hpp"
#include "client/view/window/relief.hpp"
#include "client/view/window/status.hpp"

namespace hapticast::client {

/// What is seen of everything in the window but the video.
struct PanelState {
  bool help = false;
  bool outline = false;
  ReliefLook relief = ReliefLook::kNone;
  double friction = 0.5;      ///< instead of the author's, once that is wanted
  std::string note;           ///< of the window itself, such as where a picture was saved
  double picture_off_ms = 0;  ///< the shown picture's time minus that of the felt frame
};

/// A key that changes what the user asks for; whether it was one. Keys: helpText().
bool pressKey(int sdl_key, UiState& ui_state, PanelState& state);

/// The panel, from `corner` on and `size` large; its controls change `desk.user`.
void showPanel(const ImVec2& corner, const ImVec2& size, const TickWatch& ticks,
               const ForceHistory& history, UiState& ui_state, PanelState& state);

/// The list of keys, in the middle of the part of the window of this size.
void showHelp(const ImVec2& room, bool& open);

}  // namespace hapticast::client
