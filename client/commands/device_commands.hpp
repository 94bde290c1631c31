// SPDX-License-Identifier: MIT
// Subcommands of the client that use a device without a stream: list --devices, check and its
// calibration of a Falcon.
// Thread: main.
#pragma once

#include "client/settings/settings.hpp"

namespace hapticast::client {

/// Prints the kinds of devices and the connected devices.
void printDevices(const Settings& settings);
/// Runs the subcommand check (device/check_device.hpp) and stores the result
/// (storeResult()). Returns the exit code. Throws like openDevice() and checkDevice().
int runDeviceCheck(const Settings& settings);
/// Calibrates the Falcon's motors. Returns the exit code. Throws like openDevice() and calibrate().
int runFalconCalibration(const Settings& settings);

}  // namespace hapticast::client
