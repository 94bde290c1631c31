// SPDX-License-Identifier: MIT
// Depth range estimation: finds one range of depths for a whole clip, from robust quantiles of the
// objects' depths. Thread: any.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Depths that become heights, with the usual extent of the objects.
struct MappedRange {
  DepthRange range;
  double usual_mm = 0.0;  ///< depth extent of an object, median over the frames
  /// The range is far wider than the objects: they move in depth, or their masks include
  /// background.
  bool wide = false;
};

/// Collects quantiles of the objects' depths for each frame, and computes the range.
class RangeFinder {
 public:
  /// Adds a frame of the object with id `object`. Uses pixels measured at least 3 px inside the
  /// mask.
  void add(std::uint32_t object, const Surface& surface, const DepthNoise& noise);
  /// Returns the range from the nearest front to the farthest back of all frames, without 2 % of
  /// them at each end. Both sides are widened by `margin`, a share of the range.
  /// Depths much farther from a frame's median than usual for the object do not count.
  /// The range is at least 50 mm or 60 sigma wide, for 8-bit depth 16 levels or 20 sigma. A
  /// narrower range would turn noise into force. nullopt if no frame was added.
  [[nodiscard]] std::optional<MappedRange> range(double margin) const;

 private:
  struct Voice {
    double near_mm, middle_mm, far_mm;
    double half_mm = 0.0;  // distance from the median to the end of the middle four fifths
  };
  [[nodiscard]] double reach_mm(const std::vector<Voice>& voices) const;

  std::map<std::uint32_t, std::vector<Voice>> voices_;  // by object
  double least_mm_ = 0.0;                               // least width for the noise
  double slack_mm_ = 0.0;
};

}  // namespace hapticast::server
