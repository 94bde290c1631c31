// SPDX-License-Identifier: MIT
// Value noise in space, three octaves: the solid texture of the synthetic bodies. Thread: any.
// any.
#pragma once

#include <vector>

#include "common/geometry.hpp"

namespace hapticast::server {

/// A fixed noise field.
class SolidNoise {
 public:
  SolidNoise();

  /// Returns the noise at a position, 0..1 with a mean of about 0.5: smooth, the same in every run.
  /// The finest detail is about 6 mm wide; the pattern repeats every 768 mm.
  [[nodiscard]] float at(const Vec3& position_mm) const noexcept;

 private:
  std::vector<float> lattice_;
};

}  // namespace hapticast::server
