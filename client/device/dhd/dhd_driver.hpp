// SPDX-License-Identifier: MIT
// Driver of hapticast-device for the devices of Force Dimension (omega, delta, sigma, lambda) and
// for the Falcon. The driver loads libdhd, the closed library of Force Dimension, at run time.
// Thread: those of hapticast_device.h.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `dhd`. Its options are `library` and `serial`.
const hapticast_driver* dhdDriver();

}  // namespace hapticast::client
