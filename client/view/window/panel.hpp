// SPDX-License-Identifier: MIT
// Controls of the window: the panel beside the video, and the keys.
// Thread: main.
#pragma once

#include <imgui.h>
#include <array>
#include <cstdint>
#include <string>

#include "client/haptics/safety/safety_action.hpp"
#include "client/view/force_plot.hpp"
#include "client/view/view.hpp"
#include "client/view/window/gui_renderer.hpp"
#include "client/view/window/relief.hpp"

namespace hapticast::client {

// Status of the run, as text and as numbers in the window.
// Thread: main.

/// Statistics of the ticks for the panel.
class TickWatch {
 public:
  void add(const TickReport& report);
  [[nodiscard]] const TickReport& last() const { return last_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Returns the number of ticks that began more than 1.5 ms after the tick before, as in the
  /// summary.
  [[nodiscard]] std::uint64_t lateTicks() const { return late_; }
  /// Return the longest and the mean computing time of a tick in the last complete second.
  [[nodiscard]] double longest_us() const { return longest_us_; }
  [[nodiscard]] double mean_us() const { return mean_us_; }
  /// Returns the safety actions of the last second as text.
  [[nodiscard]] std::string chain() const;

 private:
  TickReport last_;
  std::uint64_t ticks_ = 0;
  std::uint64_t late_ = 0;
  double longest_us_ = 0.0;
  double mean_us_ = 0.0;
  // For the present second:
  Duration second_longest_{0};
  Duration second_sum_{0};
  std::uint64_t second_ticks_ = 0;
  LocalTime second_begin_{};
  std::array<LocalTime, kInterferenceNames.size()> acted_{};
  std::array<bool, kInterferenceNames.size()> ever_{};
};

/// Returns a line for the user such as "in contact, 1.2 N". If there is no force, the line states
/// the reason.
[[nodiscard]] std::string statusLine(const TickReport& report, const UiState& ui_state);

/// State of the panel and of the display options.
struct PanelState {
  bool help = false;
  bool outline = false;
  ReliefLook relief = ReliefLook::kNone;
  /// Value of the friction slider. It applies only if the user replaces the author's friction.
  double friction = 0.5;
  std::string note;           ///< message in the window, such as the name of a saved picture
  double picture_off_ms = 0;  ///< media time of the shown picture minus that of the rendered frame
};

/// Carries out the function of the key `sdl_key`. Returns false if the key has no function.
/// showHelp() lists the keys.
bool pressKey(int sdl_key, UiState& ui_state, PanelState& state);

/// Draws the panel with its upper left corner at `corner`. Its controls change `ui_state.user`.
/// `renderer` receives the images of its plots.
void showPanel(const ImVec2& corner, const ImVec2& size, const TickWatch& ticks,
               const ForceHistory& history, GuiRenderer& renderer, UiState& ui_state,
               PanelState& state);

/// Draws the list of keys in the middle of an area of the size `room`. Sets `open` to false if the
/// user closes the list.
void showHelp(const ImVec2& room, bool& open);

}  // namespace hapticast::client
