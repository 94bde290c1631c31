// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/time_bar.hpp"

#include <SDL_keycode.h>
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace hapticast::client {

namespace {

constexpr double kStep_s = 5.0;  // of a key; usual in video players
constexpr std::array kSpeeds{0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0};

/// Returns M:SS.
std::string formatPlace(double time_s) {
  const int whole = static_cast<int>(time_s);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

double findSpeed(double present, int steps) {
  const auto nearest = std::min_element(
      kSpeeds.begin(), kSpeeds.end(),
      [present](double a, double b) { return std::abs(a - present) < std::abs(b - present); });
  const auto index = static_cast<int>(nearest - kSpeeds.begin()) + steps;
  return kSpeeds[static_cast<std::size_t>(
      std::clamp(index, 0, static_cast<int>(kSpeeds.size()) - 1))];
}

}  // namespace

void showTimeBar(const WindowLayout& layout, UiState& ui_state, TimeBarState& state) {
  if (!ui_state.stream.timeline) return;
  const Timeline& timeline = *ui_state.stream.timeline;
  if (timeline != state.shown) {
    state.shown = timeline;
    state.wanted = {};
    if (timeline.speed > 0.0) state.speed = timeline.speed;
  }
  ImGui::SetNextWindowPos({static_cast<float>(layout.corner.x()),
                           static_cast<float>(layout.corner.y() + layout.room.y())},
                          ImGuiCond_Always, {0.0F, 1.0F});
  ImGui::SetNextWindowSize({static_cast<float>(layout.room.x()), 0.0F});
  ImGui::SetNextWindowBgAlpha(0.6F);
  ImGui::Begin("time", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
  const double place_s = timeline.computePosition_s(state.play_time);
  const std::string text =
      fmt::format("{} / {}{}", formatPlace(place_s), formatPlace(timeline.length_s),
                  ui_state.user.paused    ? "  paused"
                  : timeline.speed == 0.0 ? "  the end"
                  : timeline.speed != 1.0 ? fmt::format("  x {:g}", timeline.speed)
                                          : "");
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text.c_str());
  ImGui::SameLine(14.0F * ImGui::GetFontSize());
  ImGui::SetNextItemWidth(-1.0F);
  if (!ImGui::IsAnyItemActive()) state.drag_s = static_cast<float>(place_s);
  ImGui::SliderFloat("##place", &state.drag_s, 0.0F, static_cast<float>(timeline.length_s), "",
                     ImGuiSliderFlags_AlwaysClamp);
  if (ImGui::IsItemDeactivatedAfterEdit())
    ui_state.timeline.seek_s = static_cast<double>(state.drag_s);
  ImGui::End();
}

bool pressTimelineKey(int sdl_key, UiState& ui_state, TimeBarState& state) {
  if (!ui_state.stream.timeline) return false;
  const Timeline& timeline = *ui_state.stream.timeline;
  const auto seekBy = [&](double step_s) {
    const double from_s = state.wanted.seek_s.value_or(timeline.computePosition_s(state.play_time));
    state.wanted.seek_s = std::clamp(from_s + step_s, 0.0, timeline.length_s);
    ui_state.timeline.seek_s = state.wanted.seek_s;
    return true;
  };
  const auto changeSpeed = [&](int steps) {
    state.wanted.speed = findSpeed(state.wanted.speed.value_or(state.speed), steps);
    ui_state.timeline.speed = state.wanted.speed;
    return true;
  };
  switch (sdl_key) {
    case SDLK_LEFT:
      return seekBy(-kStep_s);
    case SDLK_RIGHT:
      return seekBy(kStep_s);
    case SDLK_PAGEUP:
      return changeSpeed(1);
    case SDLK_PAGEDOWN:
      return changeSpeed(-1);
    default:
      return false;
  }
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
