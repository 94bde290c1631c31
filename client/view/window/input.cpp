// SPDX-License-Identifier: MIT
// Input of the window: pointer, wheel and keys.
#if HAPTICAST_IMGUI
#include "client/view/window/display.hpp"
#include "client/view/window/imgui_sdl.hpp"
#include "client/view/window/study_window.hpp"
#include "client/view/window/window.hpp"

namespace hapticast::client {

namespace {

constexpr std::uint64_t kFrame_ms = 16;  // chosen: the usual rate of a screen
constexpr double kDrag_mm_per_px = 0.1;  // chosen: half of a hand's movement is a press

/// Returns the turn of the wheel in notches, positive away from the user. A touchpad turns by
/// fractions. The system's "natural" direction does not change it.
double readNotches(const SDL_MouseWheelEvent& wheel) {
  const double exact = double{wheel.preciseY};
  const double notches = exact != 0.0 ? exact : static_cast<double>(wheel.y);
  return wheel.direction == SDL_MOUSEWHEEL_FLIPPED ? -notches : notches;
}

}  // namespace

bool ViewerWindow::update(UiState& ui_state) {
  if (displayIsLost()) return false;
  SDL_Event event;
  while (SDL_PollEvent(&event) != 0) handleEvent(event, ui_state);
  input_.update(ticks_.last(), place_, placed_, ui_state.pointer);
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
      if (ui_state.study) {
        if (event.key.keysym.sym == SDLK_F11 && event.key.repeat == 0) toggleFullscreen();
        pressStudyKey(event.key.keysym.sym, event.key.repeat != 0, ui_state);
        break;
      }
      if (io.WantTextInput || event.key.repeat != 0) break;
      if (event.key.keysym.sym == SDLK_p) save_ = true;
      if (event.key.keysym.sym == SDLK_F11) toggleFullscreen();
      (void)pressKey(event.key.keysym.sym, ui_state, state_);
      break;
    case SDL_MOUSEMOTION:
      point(event.motion, ui_state);
      break;
    case SDL_MOUSEWHEEL:
      if (!io.WantCaptureMouse) PointerInput::turnWheel(readNotches(event.wheel), ui_state.pointer);
      break;
    case SDL_MOUSEBUTTONDOWN:
      if (event.button.button == SDL_BUTTON_LEFT && place_.contains(cursor) && !io.WantCaptureMouse)
        pressButton(cursor);
      break;
    case SDL_MOUSEBUTTONUP:
      if (event.button.button == SDL_BUTTON_LEFT) drag(Drag::kNone);
      break;
    default:
      break;
  }
}

/// A press of the left button over the picture begins a drag, or closes the box of the relief.
void ViewerWindow::pressButton(const Vec2& cursor) {
  switch (findPart(cursor)) {
    case BoxPart::kClose:
      state_.relief = ReliefLook::kNone;
      break;
    case BoxPart::kTitle:
      drag(Drag::kMoves);
      break;
    case BoxPart::kBody:
      drag(Drag::kTurns);
      break;
    case BoxPart::kNone:
      drag(Drag::kPresses);
      break;
  }
}

void ViewerWindow::point(const SDL_MouseMotionEvent& motion, UiState& ui_state) {
  const Vec2 by_px(motion.xrel, motion.yrel);
  if (drag_ == Drag::kPresses) PointerInput::press(kDrag_mm_per_px * by_px.y(), ui_state.pointer);
  if (drag_ == Drag::kTurns)
    relief_.rotate(static_cast<float>(motion.xrel), static_cast<float>(motion.yrel));
  if (drag_ == Drag::kMoves) relief_.box().move(place_, by_px);
  if (drag_ != Drag::kNone) return;
  const Vec2 at(motion.x, motion.y);
  if (!place_.contains(at) || findPart(at) != BoxPart::kNone || ImGui::GetIO().WantCaptureMouse)
    return;
  input_.point(at);
}

/// During a drag of the HIP or of the view, the pointer remains at its place and has no edge to
/// stop at.
void ViewerWindow::drag(Drag what) {
  drag_ = what;
  const bool stays = what == Drag::kPresses || what == Drag::kTurns;
  SDL_SetRelativeMouseMode(stays ? SDL_TRUE : SDL_FALSE);
}

BoxPart ViewerWindow::findPart(const Vec2& point) const {
  return state_.relief == ReliefLook::kInSpace ? relief_.box().part(place_, point) : BoxPart::kNone;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
