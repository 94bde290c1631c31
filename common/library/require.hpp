// SPDX-License-Identifier: MIT
// Checks of the arguments of the library. Thread: any.
#pragma once

#include <stdexcept>
#include <string>

namespace hapticast {

/// Throws std::invalid_argument with `what` unless `holds`.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace hapticast
