// SPDX-License-Identifier: MIT
// The window in a study: the prompt in the middle of the picture, and the keys of the subject.
// Thread: main.
#pragma once

#include "client/view/view.hpp"
#include "client/view/window/layout.hpp"

namespace hapticast::client {

/// Draws the prompt of `ui_state.study`, and writes answers by the mouse to `ui_state.study_input`.
void showStudyPrompt(const WindowLayout& layout, UiState& ui_state);

/// Enters the key `sdl_key` in `ui_state.study_input`: Esc stops the force, Enter confirms, 1 to 9
/// choose, left and right move the slider. No other key has a function in a study. `is_repeat`: the
/// key is held down, which only moves the slider.
void pressStudyKey(int sdl_key, bool is_repeat, UiState& ui_state);

}  // namespace hapticast::client
