// SPDX-License-Identifier: MIT
// Keys of the window, and the help that lists them.
#if HAPTICAST_IMGUI
#include <SDL_keycode.h>
#include <array>
#include <utility>

#include "client/view/painter.hpp"
#include "client/view/pointer_input.hpp"
#include "client/view/window/panel.hpp"

namespace hapticast::client {

namespace {

constexpr std::array<std::pair<const char*, const char*>, 20> kKeys{
    {{"pointer", "moves the tip over the picture"},
     {"wheel down", "moves the tip into the picture: presses"},
     {"wheel up", "moves the tip out of the picture: lifts"},
     {"drag down, up", "presses, lifts"},
     {"Home", "brings the tip back above the picture"},
     {"space", "pauses and resumes time"},
     {"left, right", "5 s back, ahead (a recording on demand)"},
     {"page up, down", "faster, slower (a recording on demand)"},
     {"S, D", "static, dynamic force on and off"},
     {"M", "the thesis's method, and back"},
     {"R", "re-arms the force"},
     {"Enter", "confirms a request, such as the check of a device"},
     {"O", "outlines the objects"},
     {"V", "shades the relief; again: from the side; again: off"},
     {"L", "records a log: hapticast-1.csv ..."},
     {"P", "saves a picture: hapticast-1.png ..."},
     {"F1", "this help"},
     {"F2", "folds and unfolds the panel"},
     {"F11", "fills the screen, and back"},
     {"Ctrl-C", "ends, as closing the window does"}}};

/// Carries out the function of a key that only changes the display.
bool pressDisplayKey(int sdl_key, PanelState& state) {
  switch (sdl_key) {
    case SDLK_o:
      state.outline = !state.outline;
      return true;
    case SDLK_v:
      switchRelief(state);
      return true;
    case SDLK_F1:
      state.help = !state.help;
      return true;
    case SDLK_F2:
      togglePanel(state);
      return true;
    default:
      return false;
  }
}

}  // namespace

bool pressKey(int sdl_key, UiState& ui_state, PanelState& state) {
  UserControls& user = ui_state.user;
  const auto flip = [](bool& value) { value = !value; };
  switch (sdl_key) {
    case SDLK_SPACE:
      flip(user.paused);
      return true;
    case SDLK_s:
      flip(user.static_on);
      return true;
    case SDLK_d:
      flip(user.dynamic_on);
      return true;
    case SDLK_m:
      user.method = user.method == Method::kThesis ? Method::kHapticast : Method::kThesis;
      return true;
    case SDLK_r:
      ++user.rearm;
      return true;
    case SDLK_RETURN:
    case SDLK_KP_ENTER:
      ui_state.confirmed = true;
      return true;
    case SDLK_l:
      flip(ui_state.record);
      return true;
    case SDLK_HOME:
      PointerInput::lift(ui_state.pointer);
      return true;
    default:
      return pressTimelineKey(sdl_key, ui_state, state.time_bar) || pressDisplayKey(sdl_key, state);
  }
}

void showButtons(const WindowLayout& layout, PanelState& state) {
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x, 0.0F}, ImGuiCond_Always, {1.0F, 0.0F});
  ImGui::SetNextWindowSize({static_cast<float>(buttonsWidth_px(layout)), 0.0F});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(2.0F, 2.0F));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(4.0F, 2.0F));
  ImGui::Begin("buttons", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBackground);
  if (ImGui::Button("help (F1)")) state.help = !state.help;
  ImGui::SameLine();
  if (ImGui::Button("panel (F2)")) togglePanel(state);
  ImGui::End();
  ImGui::PopStyleVar(2);
}

void showLegend() {
  for (const Legend& mark : kLegend) {
    ImGui::PushStyleColor(ImGuiCol_Text, toImGui(mark.color));
    ImGui::TextUnformatted(mark.text);
    ImGui::PopStyleColor();
  }
}

void showHelp(const WindowLayout& layout, bool& open) {
  if (!open) return;
  const Vec2 middle = layout.corner + 0.5 * layout.room;
  ImGui::SetNextWindowPos({static_cast<float>(middle.x()), static_cast<float>(middle.y())},
                          ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::Begin("Keys and colours", &open,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoCollapse);
  for (const auto& [key, does] : kKeys) {
    ImGui::TextUnformatted(key);
    ImGui::SameLine(8.0F * ImGui::GetFontSize());
    ImGui::TextUnformatted(does);
  }
  ImGui::Separator();
  showLegend();
  ImGui::End();
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
