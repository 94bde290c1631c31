// SPDX-License-Identifier: MIT
// Time bar of the window, for a stream with a time line of its own (--on-demand of the server).
// Thread: main.
#pragma once

#include "client/view/view.hpp"
#include "client/view/window/layout.hpp"
#include "common/haptic_frame.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// State of the time bar.
struct TimeBarState {
  MediaTime play_time{};   ///< of the last tick
  float drag_s = 0.0F;     ///< place under the pointer while the user drags
  double speed = 1.0;      ///< of the stream, also during a pause
  Timeline shown;          ///< of the last drawing
  TimelineRequest wanted;  ///< by keys since `shown`; the stream has not changed yet
};

/// Draws the bar at the lower edge of the rectangle for the picture, and sets `ui_state.timeline`
/// if the user drags it. Draws nothing if the stream has no time line.
void showTimeBar(const WindowLayout& layout, UiState& ui_state, TimeBarState& state);

/// Carries out the function of a key of the time line: left and right seek, page up and down change
/// the speed. Returns false if the key has none.
bool pressTimelineKey(int sdl_key, UiState& ui_state, TimeBarState& state);

}  // namespace hapticast::client
