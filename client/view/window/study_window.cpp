// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/study_window.hpp"

#include <SDL_keycode.h>
#include <imgui.h>

#include <string>

namespace hapticast::client {

namespace {

constexpr double kKeyStep = 2.0;  // chosen: 50 presses for the whole scale

void showChoices(const StudyPrompt& prompt, StudyInput& input) {
  for (std::size_t i = 0; i < prompt.choices.size(); ++i) {
    const std::string text = std::to_string(i + 1) + "  " + prompt.choices[i];
    if (ImGui::Button(text.c_str(), {-1.0F, 0.0F})) input.choice = i;
  }
}

void showScale(const StudyPrompt& prompt, StudyInput& input) {
  auto value = static_cast<float>(input.scale);
  ImGui::SetNextItemWidth(-1.0F);
  // Without digits: a subject would round to them.
  if (ImGui::SliderFloat("##scale", &value, 0.0F, 100.0F, "")) input.scale = double{value};
  ImGui::TextUnformatted(prompt.low.c_str());
  const float width = ImGui::CalcTextSize(prompt.high.c_str()).x;
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width);
  ImGui::TextUnformatted(prompt.high.c_str());
}

}  // namespace

void showStudyPrompt(const WindowLayout& layout, UiState& ui_state) {
  const StudyPrompt& prompt = *ui_state.study;
  if (prompt.text.empty()) return;
  StudyInput& input = ui_state.study_input;
  const Vec2 middle = layout.corner + 0.5 * layout.room;
  const auto width = static_cast<float>(0.8 * layout.room.x());
  ImGui::SetNextWindowPos({static_cast<float>(middle.x()), static_cast<float>(middle.y())},
                          ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowSize({width, 0.0F});
  ImGui::SetNextWindowSizeConstraints({width, 0.0F}, {width, static_cast<float>(layout.room.y())});
  ImGui::Begin("study", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(prompt.text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::Spacing();
  if (prompt.is_scale) showScale(prompt, input);
  showChoices(prompt, input);
  if (prompt.needs_enter && ImGui::Button("go on (Enter)")) input.confirmed = true;
  ImGui::Spacing();
  ImGui::TextDisabled("Esc stops the force at once.");
  ImGui::End();
}

void pressStudyKey(int sdl_key, bool is_repeat, UiState& ui_state) {
  StudyInput& input = ui_state.study_input;
  if (is_repeat && sdl_key != SDLK_LEFT && sdl_key != SDLK_RIGHT) return;
  switch (sdl_key) {
    case SDLK_ESCAPE:
      input.stop = true;
      break;
    case SDLK_RETURN:
    case SDLK_KP_ENTER:
      input.confirmed = true;
      break;
    case SDLK_LEFT:
      moveScale(input, -kKeyStep);
      break;
    case SDLK_RIGHT:
      moveScale(input, kKeyStep);
      break;
    default:
      if (sdl_key >= SDLK_1 && sdl_key <= SDLK_9)
        input.choice = static_cast<std::size_t>(sdl_key - SDLK_1);
      if (sdl_key >= SDLK_KP_1 && sdl_key <= SDLK_KP_9)
        input.choice = static_cast<std::size_t>(sdl_key - SDLK_KP_1);
      break;
  }
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
