// SPDX-License-Identifier: MIT
// The text and the controls of the window: a line of status, the panel beside the video, the keys.
// Thread: main.
#pragma once

#include <imgui.h>

#include <array>
#include <cstdint>
#include <string>

#include "client/haptics/safety/interference.hpp"
#include "client/view/force_history.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// What the ticks of a run were like, for the panel.
class TickWatch {
 public:
  void add(const TickReport& report);
  [[nodiscard]] const TickReport& last() const { return last_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Began more than 1.5 ms after the one before, as the summary counts them.
  [[nodiscard]] std::uint64_t lateTicks() const { return late_; }
  /// The longest time from tick to tick of the last whole second.
  [[nodiscard]] double longest_ms() const { return longest_ms_; }
  /// What the safety chain did in the last second, in a few words; "nothing" if so.
  [[nodiscard]] std::string chain() const;

 private:
  TickReport last_;
  std::uint64_t ticks_ = 0;
  std::uint64_t late_ = 0;
  double longest_ms_ = 0.0;
  double second_longest_ms_ = 0.0;  // of the second that runs
  LocalTime second_begin_{};
  std::array<LocalTime, kInterferenceNames.size()> acted_{};
  std::array<bool, kInterferenceNames.size()> ever_{};
};

/// What is seen of everything in the window but the video.
struct PanelState {
  bool help = false;
  bool outline = false;
  std::string note;           ///< of the window itself, such as where a picture was saved
  double picture_off_ms = 0;  ///< the shown picture's time minus that of the felt frame
};

/// A plain line: "in contact, 1.2 N", or why there is no force.
[[nodiscard]] std::string statusLine(const TickReport& report, const Desk& desk);

/// A key that changes what the user asks for; whether it was one. Keys: helpText().
bool pressKey(int sdl_key, Desk& desk, PanelState& state);

/// The panel, from `corner` on and `size` large; its controls change `desk.user`.
void showPanel(const ImVec2& corner, const ImVec2& size, const TickWatch& ticks,
               const ForceHistory& history, Desk& desk, PanelState& state);

/// The list of keys, in the middle of the part of the window of this size.
void showHelp(const ImVec2& room, bool& open);

}  // namespace hapticast::client
