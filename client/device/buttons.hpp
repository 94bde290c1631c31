// SPDX-License-Identifier: MIT
// Edge detection for the buttons of a device, except its enabling button.
// Thread: main.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <utility>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Converts button states to actions of the user.
class DeviceButtons {
 public:
  /// Actions of newly pressed buttons.
  struct ButtonActions {
    bool pause = false;
    bool rearm = false;
    std::optional<int> other;  ///< a button without a function
  };

  explicit DeviceButtons(const DeviceProfile& profile)
      : pause_(profile.pause_button),
        rearm_(profile.rearm_button),
        enable_(profile.enable_button),
        initialised_(pause_ || rearm_) {}

  /// Returns the actions of the buttons pressed since the last call. Returns no action for a
  /// profile without pause and re-arming buttons.
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
