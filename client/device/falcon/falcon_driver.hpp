// SPDX-License-Identifier: MIT
// The Falcon as a driver of hapticast-device. One tick: a request goes out each millisecond, in
// wait(). It carries the newest force. The reply ends the wait. Half a millisecond after the
// request the tick begins without its reply.
// Thread: those of hapticast_device.h.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `falcon`. Its options are `firmware`, `gain`, `event_character`.
const hapticast_driver* falconDriver();

/// Returns the largest force in N that the motors render in every direction at every position of
/// the workspace, for a gain in counts/(N m). Beyond it the pilot scales the motors down.
double computeFalconPeak_N(double gain);

}  // namespace hapticast::client
