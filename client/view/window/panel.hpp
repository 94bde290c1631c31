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
#include "client/view/window/relief.hpp"

namespace hapticast::client {

// Status of the run in the window, as text and numbers.
// Thread: main.

/// Statistics of the ticks for the panel.
class TickWatch {
 public:
  void add(const TickReport& report);
  [[nodiscard]] const TickReport& last() const { return last_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Ticks that began more than 1.5 ms after the tick before, as in the summary.
  [[nodiscard]] std::uint64_t lateTicks() const { return late_; }
  /// Longest and mean tick of the last complete second.
  [[nodiscard]] double longest_us() const { return longest_us_; }
  [[nodiscard]] double mean_us() const { return mean_us_; }
  /// Safety actions of the last second as text.
  [[nodiscard]] std::string chain() const;

 private:
  TickReport last_;
  std::uint64_t ticks_ = 0;
  std::uint64_t late_ = 0;
  double longest_us_ = 0.0;
  double mean_us_ = 0.0;
  // Of the present second:
  Duration second_longest_{0};
  Duration second_sum_{0};
  std::uint64_t second_ticks_ = 0;
  LocalTime second_begin_{};
  std::array<LocalTime, kInterferenceNames.size()> acted_{};
  std::array<bool, kInterferenceNames.size()> ever_{};
};

/// Returns a line such as "in contact, 1.2 N", or the reason of a missing force.
[[nodiscard]] std::string statusLine(const TickReport& report, const UiState& ui_state);

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
