// SPDX-License-Identifier: MIT
// Converts what a driver says about its device to the profile of the safety chain. It limits every
// value, and assumes a careful one for each unknown value.
// Thread: main.
#pragma once

#include <string>

#include "client/device/device_profile.hpp"
#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Largest force of a device without a watchdog of its own, until the user gives a --profile. It is
/// the peak of an Omni.
inline constexpr double kPeakWithoutWatchdog_N = 3.3;

/// Returns a profile with all values unknown.
hapticast_profile unknownProfile() noexcept;

/// Returns the profile of the driver `name`. `users` is the value of --profile: its limits replace
/// those of the driver, and allow more than kPeakWithoutWatchdog_N. The buttons are the driver's.
/// The delay is the longer one. Throws std::runtime_error (one line) for a bad `users`.
PlantProfile convertProfile(const std::string& name, const hapticast_profile& driver,
                            const std::string& users);

}  // namespace hapticast::client
