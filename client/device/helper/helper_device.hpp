// SPDX-License-Identifier: MIT
// A haptic device whose driver runs in a helper process (hapticast-device). The loop exchanges
// forces and readings with the helper through a shared page. A thread of this object waits for
// messages of the helper and for its end. If the helper ends unexpectedly, the thread starts
// another one, at most three times. The new helper opens the device and commands zero.
// Thread: main, before the loop.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/device/device_request.hpp"

namespace hapticast::client {

/// Opens the device of the driver `request.kind` in a helper process and returns it. Throws
/// DeviceAbsent or std::runtime_error like OpenDevice.
std::unique_ptr<HapticDevice> openHelperDevice(const DeviceRequest& request);

/// Runs the driver `request.kind` in a helper process to list the connected devices, for at most
/// two seconds. Returns one line for each device. Throws std::runtime_error (one line) if the
/// driver cannot answer.
std::vector<std::string> listHelperDevices(const DeviceRequest& request);

}  // namespace hapticast::client
