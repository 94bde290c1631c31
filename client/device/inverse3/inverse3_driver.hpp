// SPDX-License-Identifier: MIT
// Driver of hapticast-device for the Haply Inverse3 and Minverse. It exchanges messages with the
// manufacturer's service, which runs on this machine. In each tick, wait() sends the newest force
// and receives the state with which the service answers. So a force reaches the device at least one
// tick after its reading.
// Thread: those of hapticast_device.h.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `inverse3`. Its options are `service` (HOST:PORT), `preset`, and `force_key`
/// (vector or values).
const hapticast_driver* inverse3Driver();

}  // namespace hapticast::client
