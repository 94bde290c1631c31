// SPDX-License-Identifier: MIT
// Input of the window: pointer, wheel and keys.
#if HAPTICAST_IMGUI
#include <backends/imgui_impl_sdl.h>

#include <algorithm>

#include "client/view/window/display.hpp"
#include "client/view/window/window.hpp"

namespace hapticast::client {

namespace {

constexpr std::uint64_t kFrame_ms = 16;  // chosen: the usual rate of a screen
constexpr double kWheel_mm = 1.0;        // chosen: per notch of the wheel
constexpr double kDrag_mm_per_px = 0.1;  // chosen: half of a hand's movement is a press
// Limits of the HIP before and behind the picture.
constexpr double kNearest_mm = 35.0;
constexpr double kFarthest_mm = -5.0;

bool within(const ImVec4& box, const Vec2& point) {
  return point.x() >= box.x && point.y() >= box.y && point.x() < box.z && point.y() < box.w;
}

}  // namespace

bool ViewerWindow::update(UiState& ui_state) {
  if (displayIsLost()) return false;
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) handleEvent(event, ui_state);
  const std::uint64_t now_ms = SDL_GetTicks64();
  if (now_ms - drawn_ms_ >= kFrame_ms && !displayIsLost()) {
    drawn_ms_ = now_ms;
    draw(ui_state);
  }
  return !closed_ && !displayIsLost();
}

void ViewerWindow::handleEvent(const SDL_Event& event, UiState& ui_state) {
  handleDisplayEvents(event);
  ImGui_ImplSDL2_ProcessEvent(&event);
  const ImGuiIO& io = ImGui::GetIO();
  const Vec2 cursor(event.button.x, event.button.y);
  switch (event.type) {
    case SDL_QUIT:
      closed_ = true;
      break;
    case SDL_KEYDOWN:
      if (io.WantTextInput || event.key.repeat != 0) break;
      if (event.key.keysym.sym == SDLK_p) save_ = true;
      (void)pressKey(event.key.keysym.sym, ui_state, state_);
      break;
    case SDL_MOUSEMOTION:
      point(event.motion, ui_state);
      break;
    case SDL_MOUSEWHEEL:
      if (!io.WantCaptureMouse) press(-kWheel_mm * double{event.wheel.preciseY}, ui_state);
      break;
    case SDL_MOUSEBUTTONDOWN:
      if (event.button.button == SDL_BUTTON_LEFT && place_.contains(cursor) && !io.WantCaptureMouse)
        drag(isRotating(cursor) ? Drag::kTurns : Drag::kPresses);
      break;
    case SDL_MOUSEBUTTONUP:
      if (event.button.button == SDL_BUTTON_LEFT) drag(Drag::kNone);
      break;
    default:
      break;
  }
}

void ViewerWindow::point(const SDL_MouseMotionEvent& motion, UiState& ui_state) {
  if (drag_ == Drag::kPresses) press(kDrag_mm_per_px * motion.yrel, ui_state);
  if (drag_ == Drag::kTurns)
    relief_.rotate(static_cast<float>(motion.xrel), static_cast<float>(motion.yrel));
  if (drag_ != Drag::kNone) return;
  const Vec2 at(motion.x, motion.y);
  if (!place_.contains(at) || isRotating(at) || ImGui::GetIO().WantCaptureMouse) return;
  if (!ui_state.pointer.known) {  // the depth begins at the HIP
    ui_state.pointer = {.known = true, .position_mm = ticks_.last().hip_mm};
    press(0.0, ui_state);
  }
  ui_state.pointer.position_mm.head<2>() = place_.toNominal(at);
}

/// Moves the target into the picture.
void ViewerWindow::press(double by_mm, UiState& ui_state) const {
  double& z_mm = ui_state.pointer.position_mm.z();
  z_mm = std::clamp(z_mm - by_mm, kFarthest_mm, kNearest_mm);
}

/// During a drag the pointer remains at its place and has no edge to stop at.
void ViewerWindow::drag(Drag what) {
  drag_ = what;
  SDL_SetRelativeMouseMode(what == Drag::kNone ? SDL_FALSE : SDL_TRUE);
}

bool ViewerWindow::isRotating(const Vec2& point) const {
  return state_.relief == ReliefLook::kInSpace && within(WindowRelief::box(place_), point);
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
