// SPDX-License-Identifier: MIT
// The Touch of 3D Systems (Phantom Omni) as a driver of hapticast-device. The closed library libHD
// of OpenHaptics is loaded at run time. Its thread calls back a thousand times a second; forces are
// set there only. exchange() hands the newest force over, and the callback hands the newest
// position back, without a lock.
// Thread: those of hapticast_device.h, and the library's.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `touch`. Its options are `library`, `serial`, and `name`: the name of the
/// device in the maker's set-up program.
const hapticast_driver* touchDriver();

}  // namespace hapticast::client
