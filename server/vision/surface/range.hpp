// SPDX-License-Identifier: MIT
// One depth range for a whole clip: found from the objects' own depth.
#pragma once

#include <optional>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Collects measured depths of objects and gives the range that holds them.
class RangeFinder {
 public:
  void add(const Surface& surface, const DepthNoise& noise);
  /// 0.2 and 99 percentile widened by `margin` of their span on both sides; at least 100 mm or 60
  /// sigma wide. nullopt when nothing was added.
  [[nodiscard]] std::optional<DepthRange> range(double margin) const;

 private:
  static constexpr double kBin_mm = 0.5;
  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
  double sigma_mm_ = 0.0;
};

}  // namespace hapticast::server
