// SPDX-License-Identifier: MIT
#include "client/view/study_prompt.hpp"

#include <algorithm>

namespace hapticast::client {

namespace {
constexpr double kButtonStep = 5.0;  // chosen: 20 presses for the whole scale
}  // namespace

void enterButton(const StudyPrompt& prompt, int number, StudyInput& input) {
  if (prompt.is_scale && number < 2) {
    moveScale(input, number == 0 ? -kButtonStep : kButtonStep);
  } else if (static_cast<std::size_t>(number) < prompt.choices.size()) {
    input.choice = static_cast<std::size_t>(number);
  } else if (prompt.choices.empty()) {
    input.confirmed = true;
  }
}

void moveScale(StudyInput& input, double step) {
  input.scale = std::clamp(input.scale + step, 0.0, 100.0);
}

}  // namespace hapticast::client
