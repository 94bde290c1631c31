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
/// Runs the check of --check-device (device/check_device.hpp) with the user, and stores the result.
/// Returns the exit code. Throws like openDevice() and checkDevice().
int runDeviceCheck(const Settings& settings);
/// Calibrates the Falcon's motors. Returns the exit code. Throws like openDevice() and calibrate().
int runFalconCalibration(const Settings& settings);

/// Applies the last stored check of `device` to its `profile` (applyCheck()). Does nothing if there
/// is none. Throws DeviceAbsent (one line) if that check found a fault.
void applyStoredCheck(const HapticDevice& device, DeviceProfile& profile);

}  // namespace hapticast::client
