// SPDX-License-Identifier: MIT
// Test reliefs of the codecs: reliefs of bodies given by formulas, of bodies seen by sensors, and
// of the real clips' objects, smoothed by the server or as the sensor gave them. Thread: any.
#pragma once

#include <string>
#include <vector>

#include "common/haptic_frame.hpp"
#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

struct CodecShape {
  std::string name;
  std::vector<Relief> frames;
  bool raw = false;    ///< not smoothed
  bool tuned = false;  ///< the codec's constants were chosen on shapes of this kind
};

/// All of them; a real clip that is absent is left out of `report`.
std::vector<CodecShape> codecShapes(bool quick, Report& report);

}  // namespace hapticast::evaluate
