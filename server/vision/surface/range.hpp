// SPDX-License-Identifier: MIT
// One range of depths for a whole clip, which becomes the heights: found from the objects' own
// bulk. Thread: any.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// The depths that become heights, and what of it the objects need.
struct MappedRange {
  DepthRange range;
  double usual_mm = 0.0;  ///< from front to back of an object, median over the frames
  /// The objects reach over so much more than they are deep: they move in depth, or their masks
  /// hold what is not theirs.
  bool wide = false;
};

/// Collects the depths of objects, a voice each frame, and gives the range that holds them.
class RangeFinder {
 public:
  /// `object`: its id. Of a frame counts what was measured 3 px and more inside the mask.
  void add(std::uint32_t object, const Surface& surface, const DepthNoise& noise);
  /// From the nearest of the fronts to the farthest of the backs of all frames, but for 2 % of
  /// them, widened by `margin` of it on both sides. What reaches much farther from a frame's middle
  /// than the object does in its usual frame is not the object's. At least 50 mm or 60 sigma wide,
  /// 16 levels of 8-bit depth: stretching less over all heights would make noise a force. nullopt
  /// when nothing was added.
  [[nodiscard]] std::optional<MappedRange> range(double margin) const;

 private:
  struct Voice {
    double near_mm, middle_mm, far_mm;
    double half_mm = 0.0;  // from the middle to where four fifths of the pixels end
  };
  [[nodiscard]] double reach_mm(const std::vector<Voice>& voices) const;

  std::map<std::uint32_t, std::vector<Voice>> voices_;  // by object
  double least_mm_ = 0.0;                               // as wide as noise asks for
  double slack_mm_ = 0.0;
};

}  // namespace hapticast::server
