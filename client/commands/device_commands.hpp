// SPDX-License-Identifier: MIT
// Commands of the client that use a device without a stream: --list-devices, --check-device,
// --falcon-calibrate.
// Thread: main.
#pragma once

#include "client/settings/settings.hpp"

namespace hapticast::client {

/// Prints the kinds of devices and the connected devices.
void printDevices(const Settings& settings);
/// Runs the check of --check-device (device/check_device.hpp) and stores the result
/// (storeResult()). Returns the exit code. Throws like openDevice() and checkDevice().
int runDeviceCheck(const Settings& settings);
/// Calibrates the Falcon's motors. Returns the exit code. Throws like openDevice() and calibrate().
int runFalconCalibration(const Settings& settings);

}  // namespace hapticast::client
