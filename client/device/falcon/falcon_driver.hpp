// SPDX-License-Identifier: MIT
// Driver of hapticast-device for the Falcon. In each tick, wait() sends a request with the newest
// force to the device and then waits for its reply. If no reply arrives within 0.5 ms, the tick
// begins without it.
// Thread: those of hapticast_device.h.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `falcon`. Its options are `firmware`, `gain`, `event_character`.
const hapticast_driver* falconDriver();

/// Returns the largest force in N that the motors render in every direction at every position of
/// the workspace, for a gain in counts/(N m). For a larger force the pilot scales all motors down
/// (falconMotors()).
double computeFalconPeak_N(double gain);

}  // namespace hapticast::client
