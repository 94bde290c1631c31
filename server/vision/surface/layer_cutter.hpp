// SPDX-License-Identifier: MIT
// The layers of one object from frame to frame, under names that stay. Thread: vision's.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/layers.hpp"

namespace hapticast::server {

/// Cuts one object from frame to frame. Layers keep their names while they lie over where they
/// were, moved with the object; a pixel takes another name only when three frames in a row say so,
/// or where an edge moves on a little; a cut is kept until its step is below 0.7 of what made it.
class LayerCutter {
 public:
  /// Surfaces of the layers by name, those that have gone with an empty box; one without steps is
  /// `surface` itself. They begin nearest first. `mapped_range` as for findLayers().
  std::vector<Surface> cut(const Surface& surface, double step_mm,
                           const DepthRange& mapped_range = kAllDepths);

 private:
  [[nodiscard]] cv::Mat assignNames(const Surface& surface, double step_mm,
                                    const DepthRange& mapped_range);
  [[nodiscard]] cv::Mat isSettled(const Surface& surface, const cv::Mat& now,
                                  const cv::Mat& before);
  [[nodiscard]] cv::Mat warpedNames(const cv::Mat& image, const Surface& surface) const;

  cv::Mat names_;            // over the last box, CV_8UC1, 1 ..; empty with one
  cv::Mat pending_changes_;  // likewise: frames in a row in which a pixel seemed to have another
  int count_ = 0;            // of the names; 0: there was no frame yet
  cv::Mat last_mask_;
  cv::Rect last_box_;
  cv::Point2d last_centroid_px_;
};

}  // namespace hapticast::server
