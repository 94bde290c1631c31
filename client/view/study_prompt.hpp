// SPDX-License-Identifier: MIT
// What a study shows its subject, and what the subject enters. In a study the window has no panel,
// no force arrows and no status line, because they would show the condition.
// Thread: main.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hapticast::client {

struct StudyPrompt {
  std::string text;                    ///< empty: a trial plays, and the subject touches
  std::vector<std::string> choices{};  ///< answers: buttons, and the keys 1 to 9
  bool is_scale = false;               ///< a slider of 0..100 in place of choices
  std::string low{}, high{};           ///< labels of the ends of the slider
  bool needs_enter = false;            ///< Enter goes on
};

/// Input since the last prompt.
struct StudyInput {
  bool confirmed = false;               ///< Enter
  std::optional<std::size_t> choice{};  ///< place in StudyPrompt::choices
  double scale = 50.0;                  ///< of the slider
  bool stop = false;                    ///< Esc: the force has to end at once
};

/// Enters the press of the button `number` of a device (0: the first one): it chooses, moves the
/// slider (first and second button) or confirms.
void enterButton(const StudyPrompt& prompt, int number, StudyInput& input);

/// Changes the slider by `step`, within 0..100.
void moveScale(StudyInput& input, double step);

}  // namespace hapticast::client
