// SPDX-License-Identifier: MIT
// The Haply Inverse3 and Minverse as a driver of hapticast-device. The service of the manufacturer
// runs on this machine. One tick: wait() sends the newest force and receives the state that answers
// it. So a force reaches the device one tick after its reading at least.
// Thread: those of hapticast_device.h.
#pragma once

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the driver `inverse3`. Its options: `service` (HOST:PORT), `preset`, `force_key`
/// (vector or values).
const hapticast_driver* inverse3Driver();

}  // namespace hapticast::client
