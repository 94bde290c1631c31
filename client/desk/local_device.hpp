// SPDX-License-Identifier: MIT
// The device of the viewer's desk, its renderer, and what the haptic loop reads and writes.
// Thread: main; the loop uses the members by their own rules.
#pragma once

#include <memory>

#include "client/desk/user_interface.hpp"
#include "client/device/open_device.hpp"
#include "client/haptics/renderer.hpp"
#include "client/settings/settings.hpp"

namespace hapticast::client {

struct LocalDevice {
  /// Opens the device of `settings`. Throws std::runtime_error (one line) if that fails, or if a
  /// device that was never checked cannot be confirmed in `ui`.
  LocalDevice(const Settings& settings, const Clock& clock, UserInterface& ui);
  /// Creates the renderer, for the device's profile with the changes of its check.
  void createRenderer(const Settings& settings, UserInterface& ui);
  /// Sets `profile` and `is_checked` by the stored check of the device.
  void readCheck();

  std::unique_ptr<HapticDevice> device;
  bool is_auto_detected = false;       ///< a real device that the user did not name
  DeviceProfile profile;               ///< with the changes of the last check of the device
  bool is_checked = false;             ///< false: runFirstCheck() has to come first
  RendererSettings renderer_settings;  ///< the renderer reads it
  FramePool pool;
  LatestValue<StreamTiming> stream;
  /// Of every tick: plots, sound, logs and the counts of the panel would miss a peak of 1 ms in a
  /// latest value.
  HapticRenderer::Log reports;
  std::unique_ptr<HapticRenderer> renderer;  ///< large: holds the flight recorder
};

}  // namespace hapticast::client
