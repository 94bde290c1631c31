// SPDX-License-Identifier: MIT
// Selects and opens the device that the settings request.
// Thread: main, before the loop.
#pragma once

#include <memory>

#include "client/device/open_device.hpp"
#include "client/settings.hpp"

namespace hapticast::client {

struct SelectedDevice {
  std::unique_ptr<HapticDevice> device;
  bool auto_detected = false;  ///< detected without an explicit request: needs a confirmation
};

/// Opens the device. With `auto` that is a detected real device that answers, else the fallback of
/// openDevice(). A scripted hand (--hand) with `auto` selects the virtual device. All references
/// must outlive the device; `pointer` may be null. Throws like openDevice().
SelectedDevice selectDevice(const Settings& settings, const Clock& clock,
                            LatestValue<TickReport>& seen, LatestValue<PointerTarget>* pointer);

}  // namespace hapticast::client
