// SPDX-License-Identifier: MIT
// Converts the properties that a driver states for its device to the profile of the safety chain.
// It limits every value. For an unknown value it assumes a cautious one.
// Thread: main.
#pragma once

#include <string>

#include "client/device/hapticast_device.h"
#include "client/device/profile/device_profile.hpp"

namespace hapticast::client {

/// Largest force of a device that has no watchdog, unless the user sets --profile. It is the peak
/// of an Omni.
inline constexpr double kPeakWithoutWatchdog_N = 3.3;

/// Returns the profile in which all values are unknown. A driver fills it.
hapticast_profile unknownProfile() noexcept;

/// Returns the profile for the driver `name`. If `users` (the value of --profile) is empty, the
/// result follows from `driver`. Otherwise it is the profile `users`, which may exceed
/// kPeakWithoutWatchdog_N, with the longer one of the two delays. The pause and re-arming buttons
/// are always those of `driver`. Throws std::runtime_error (one line) if `users` is no valid
/// profile.
PlantProfile convertProfile(const std::string& name, const hapticast_profile& driver,
                            const std::string& users);

}  // namespace hapticast::client
