// SPDX-License-Identifier: MIT
// Driver of hapticast-device for the Touch of 3D Systems (Phantom Omni). It loads libHD, the closed
// library of OpenHaptics, at run time. A thread of libHD calls the driver's callback a thousand
// times a second. Only this callback sets forces. exchange() passes the newest force to the
// callback, and returns the newest position that the callback has read. Neither function locks a
// mutex.
// Thread: the driver's functions as in hapticast_device.h; the callback in libHD's thread.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `touch`. Its options are `library`, `serial`, and `name` (the name of the
/// device in the manufacturer's set-up program).
const hapticast_driver* touchDriver();

}  // namespace hapticast::client
