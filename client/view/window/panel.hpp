// SPDX-License-Identifier: MIT
// Controls of the window: the panel beside the video, and the keys.
// Thread: main.
#pragma once

#include <imgui.h>
#include <optional>
#include <string>

#include "client/view/force_plot.hpp"
#include "client/view/status.hpp"
#include "client/view/view.hpp"
#include "client/view/window/gui_renderer.hpp"
#include "client/view/window/layout.hpp"
#include "client/view/window/relief.hpp"
#include "client/view/window/time_bar.hpp"

namespace hapticast::client {

/// State of the panel and of the display options.
struct PanelState {
  bool help = false;
  bool outline = false;
  ReliefLook relief = ReliefLook::kNone;
  /// The user's choice: true shows the panel, false folds it. nullopt: the width of the window
  /// decides.
  std::optional<bool> panel = std::nullopt;
  bool folded = false;  ///< true: the last drawing had no panel
  /// Value of the friction slider. It applies only if the user replaces the author's friction.
  double friction = 0.5;
  TimeBarState time_bar;
  std::string note;           ///< message in the window, such as the name of a saved picture
  double picture_off_ms = 0;  ///< media time of the shown picture minus that of the rendered frame
};

/// Carries out the function of the key `sdl_key`. Returns false if the key has no function.
/// showHelp() lists the keys.
bool pressKey(int sdl_key, UiState& ui_state, PanelState& state);

/// Selects the next display of the relief: shaded, from the side, none.
inline void switchRelief(PanelState& state) {
  state.relief = static_cast<ReliefLook>((static_cast<int>(state.relief) + 1) % 3);
}

/// Folds the panel, or unfolds it.
inline void togglePanel(PanelState& state) { state.panel = state.folded; }

/// Draws the panel at the right edge of the window. Its controls change `ui_state.user`. `renderer`
/// receives the images of its plots.
void showPanel(const WindowLayout& layout, const TickStatus& ticks, const ForceHistory& history,
               GuiRenderer& renderer, UiState& ui_state, PanelState& state);

/// Draws two buttons at the upper right edge of the window, for a folded panel: they unfold the
/// panel and show the help.
void showButtons(const WindowLayout& layout, PanelState& state);

/// Draws the list of keys and the legend in the middle of the rectangle for the picture. Sets
/// `open` to false if the user closes the list.
void showHelp(const WindowLayout& layout, bool& open);

/// Writes a line for each mark in the picture, in the colour of the mark.
void showLegend();

}  // namespace hapticast::client
