// SPDX-License-Identifier: MIT
// Devices of Force Dimension (omega, delta, sigma, lambda), and the Falcon, as a driver of
// hapticast-device. Force Dimension's closed library libdhd is loaded at run time.
// Thread: those of hapticast_device.h.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `dhd`. Its options are `library` and `serial`.
const hapticast_driver* dhdDriver();

}  // namespace hapticast::client
