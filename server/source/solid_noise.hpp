// SPDX-License-Identifier: MIT
// A fixed noise texture in space, three octaves: what the synthetic bodies are made of. Thread:
// any.
#pragma once

#include <vector>

#include "common/geometry.hpp"

namespace hapticast::server {

class SolidNoise {
 public:
  SolidNoise();

  /// 0..1 with a mean of about 0.5, smooth, the same in every run. The finest detail is some 6 mm
  /// wide and the pattern repeats every 768 mm.
  [[nodiscard]] float at(const Vec3& position_mm) const noexcept;

 private:
  std::vector<float> lattice_;
};

}  // namespace hapticast::server
