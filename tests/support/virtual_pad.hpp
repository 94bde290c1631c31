// SPDX-License-Identifier: MIT
// A gamepad that SDL itself makes up: plugged in and out, its sticks and buttons moved, its motors
// watched. Thread: main, as everything of SDL's.
#pragma once

#include <SDL.h>

#include <stdexcept>

namespace hapticast::testing {

class VirtualPad {
 public:
  /// How strongly its motors turn, by the last command.
  struct Motors {
    std::uint16_t low = 0;
    std::uint16_t high = 0;
  };

  VirtualPad() {
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) throw std::runtime_error(SDL_GetError());
  }
  VirtualPad(const VirtualPad&) = delete;
  VirtualPad& operator=(const VirtualPad&) = delete;
  ~VirtualPad() {
    if (index_ >= 0) unplug();
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }

  /// Whether somebody's real ones are there, which would be taken for it.
  [[nodiscard]] static bool others() { return SDL_NumJoysticks() > 0; }

  void plug(bool with_motors = true) {
    SDL_VirtualJoystickDesc pad{};
    pad.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    pad.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    pad.naxes = SDL_CONTROLLER_AXIS_MAX;
    pad.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    pad.name = "made-up pad";
    pad.userdata = this;
    if (with_motors) pad.Rumble = turn;
    index_ = SDL_JoystickAttachVirtualEx(&pad);
    joystick_ = SDL_JoystickOpen(index_);
    if (joystick_ == nullptr) throw std::runtime_error(SDL_GetError());
  }
  void unplug() {
    SDL_JoystickClose(joystick_);
    SDL_JoystickDetachVirtual(index_);
    index_ = -1;
  }
  /// -1..1, as SDL has it: right and down positive.
  void stick(SDL_GameControllerAxis axis, double to) {
    SDL_JoystickSetVirtualAxis(joystick_, axis, static_cast<std::int16_t>(32767.0 * to));
  }
  void press(SDL_GameControllerButton button, bool down = true) {
    SDL_JoystickSetVirtualButton(joystick_, button, down ? 1 : 0);
  }

  Motors motors;

 private:
  static int turn(void* pad, std::uint16_t low, std::uint16_t high) {
    static_cast<VirtualPad*>(pad)->motors = {low, high};
    return 0;
  }

  int index_ = -1;
  SDL_Joystick* joystick_ = nullptr;
};

}  // namespace hapticast::testing
