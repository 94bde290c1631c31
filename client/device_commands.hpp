// SPDX-License-Identifier: MIT
// Commands of the client that use a device without a stream: --list-devices, --check-device,
// --falcon-calibrate.
// Thread: main.
#pragma once

#include "client/haptics/haptic_device.hpp"
#include "client/settings.hpp"

namespace hapticast::client {

/// Prints the kinds of devices and the connected devices.
void printDevices(const Settings& settings);
/// Checks with the user that the device of --check-device moves as it is commanded, and stores the
/// result. Returns the exit code. Throws like openDevice() and checkDevice().
int runDeviceCheck(const Settings& settings);
/// Calibrates the Falcon's motors. Returns the exit code. Throws like openDevice() and calibrate().
int runFalconCalibration(const Settings& settings);

/// Throws DeviceAbsent (one line) if the last check of `device` refused it.
void requireNotRefused(const HapticDevice& device);

}  // namespace hapticast::client
