// SPDX-License-Identifier: MIT
// Checks of the arguments of the library. Thread: any.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace hapticast {

/// Throws std::invalid_argument with `what` unless `holds`.
inline void require(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

/// Returns `value`. Throws std::invalid_argument unless low <= value <= high; a NaN is outside
/// every range. `unit` follows the range in the message, such as " N/mm".
inline double requireRange(double value, double low, double high, const char* what,
                           const char* unit = "") {
  require(value >= low && value <= high,
          fmt::format("{}: {} is outside {}..{}{}", what, value, low, high, unit));
  return value;
}

}  // namespace hapticast
