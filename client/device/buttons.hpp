// SPDX-License-Identifier: MIT
// Buttons of a device: detects new presses and converts them to actions (pause, re-arm). A press of
// the enabling button (dead-man's switch) causes no action here; the loop reads that button itself.
// Thread: main.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <utility>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Converts the states of the buttons to actions of the user.
class DeviceButtons {
 public:
  /// Actions of the buttons that were newly pressed.
  struct ButtonActions {
    bool pause = false;
    bool rearm = false;
    std::optional<int> other;  ///< number of a pressed button that has no function
  };

  explicit DeviceButtons(const DeviceProfile& profile)
      : pause_(profile.pause_button),
        rearm_(profile.rearm_button),
        enable_(profile.enable_button),
        initialised_(pause_ || rearm_) {}

  /// Returns the actions of the buttons that were pressed since the last call. `buttons` has one
  /// bit for each button that is down now. If the profile has neither a pause button nor a
  /// re-arming button, the result has no action.
  [[nodiscard]] ButtonActions onButtons(std::uint32_t buttons) {
    const std::uint32_t pressed = buttons & ~std::exchange(last_, buttons);
    ButtonActions wish;
    if (pressed == 0 || !initialised_) return wish;
    const auto is = [pressed](const std::optional<int>& button) {
      return button && (pressed >> *button & 1U) != 0;
    };
    wish.pause = is(pause_);
    wish.rearm = is(rearm_);
    if (!wish.pause && !wish.rearm && !is(enable_)) wish.other = std::countr_zero(pressed);
    return wish;
  }

 private:
  std::optional<int> pause_;
  std::optional<int> rearm_;
  std::optional<int> enable_;
  bool initialised_;
  std::uint32_t last_ = 0;
};

}  // namespace hapticast::client
