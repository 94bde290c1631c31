// SPDX-License-Identifier: MIT
// Other codecs for a relief: each over the object's rectangle, 0 outside the mask. Thread:
// any.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/haptic_frame.hpp"

namespace hapticast::evaluate {

/// Result of a codec for a relief.
struct Coded {
  std::size_t bytes = 0;
  double encode_us = 0.0;
  double decode_us = 0.0;
  double error_mm = 0.0;  ///< of the worst pixel
};

struct Rival {
  std::string name;
  std::function<Coded(const Relief&, double error_mm)> code;
};

/// JPEG-LS (the shortest of three divisions of the bound into rounding and near-lossless steps),
/// PNG, zstd, plain 16 bit; those whose library was there when this was built.
std::vector<Rival> codecRivals();

}  // namespace hapticast::evaluate
