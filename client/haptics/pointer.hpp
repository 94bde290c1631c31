// SPDX-License-Identifier: MIT
// Target of a pointing device. The window writes it, a device that follows the pointer (mouse)
// reads it.
// Thread: any; LatestValue carries it between threads.
#pragma once

#include "common/geometry.hpp"

namespace hapticast::client {

/// A target for the HIP, without ownership.
struct PointerTarget {
  bool known = false;               ///< false until the pointer was over the picture
  Vec3 position_mm = Vec3::Zero();  ///< nominal frame
};

}  // namespace hapticast::client
