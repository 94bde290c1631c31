// SPDX-License-Identifier: MIT
// Depth range estimation: finds one mapped range for a whole clip, from robust quantiles of the
// objects' depths in all frames. Thread: any.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Mapped range (depths that become heights 30 and 0), with the usual extent of the objects in
/// depth.
struct MappedRange {
  DepthRange range;
  double usual_mm = 0.0;  ///< extent of an object in depth, median over the frames
  /// True: the range is far wider than the objects, because they move in depth or their masks
  /// include background.
  bool wide = false;
};

/// Collects quantiles of the objects' depths for each frame, and computes the range.
class RangeFinder {
 public:
  /// Adds the surface of object `object` in one frame. It uses pixels that were measured and lie at
  /// least 3 px inside the mask.
  void add(std::uint32_t object, const Surface& surface, const DepthNoise& noise);
  /// Returns the mapped range, or nullopt if no frame was added. It extends from the objects'
  /// nearest front to their farthest back in all frames. The nearest 2 % of the fronts and the
  /// farthest 2 % of the backs do not count. Both sides are widened by `margin`, a share of the
  /// range. Depths that lie much farther from the frame's median than usual for the object do not
  /// count. The range is at least 50 mm or 60 standard deviations of the noise wide. For 8-bit
  /// depth it is at least 16 levels or 20 standard deviations wide. A narrower range would turn
  /// noise into force.
  [[nodiscard]] std::optional<MappedRange> range(double margin) const;

 private:
  struct Voice {
    double near_mm, middle_mm, far_mm;
    double half_mm = 0.0;  // half of the extent of the middle four fifths of the depths
  };
  [[nodiscard]] double reach_mm(const std::vector<Voice>& voices) const;

  std::map<std::uint32_t, std::vector<Voice>> voices_;  // quantiles of all frames, by object
  double least_mm_ = 0.0;                               // least width for the noise
  double slack_mm_ = 0.0;
};

}  // namespace hapticast::server
