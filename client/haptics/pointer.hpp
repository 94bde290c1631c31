// SPDX-License-Identifier: MIT
// Where a pointer on a screen wants the tip: a window writes it, a device that is a pointer reads
// it.
#pragma once

#include "common/geometry.hpp"

namespace hapticast::client {

/// A plain value that owns nothing.
struct PointerTarget {
  bool known = false;               ///< the pointer has been over the picture
  Vec3 position_mm = Vec3::Zero();  ///< nominal
};

}  // namespace hapticast::client
