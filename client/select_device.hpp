// SPDX-License-Identifier: MIT
// Which device the settings ask for. Thread: main, before the loop.
#pragma once

#include <memory>

#include "client/device/open_device.hpp"
#include "client/settings.hpp"

namespace hapticast::client {

struct SelectedDevice {
  std::unique_ptr<HapticDevice> device;
  bool auto_detected = false;  ///< a real one that nobody has asked for
};

/// Whoever asks for nothing gets a real device where one answers, whoever asks for a scripted hand
/// the virtual one. What is referred to outlives the device; `pointer` may be null. Throws as
/// openDevice() does.
SelectedDevice selectDevice(const Settings& settings, const Clock& clock,
                            LatestValue<PointerTarget>* pointer);

}  // namespace hapticast::client
