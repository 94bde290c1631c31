// SPDX-License-Identifier: MIT
// Temporal consistency of an object's layers: names persist from frame to frame, with hysteresis
// against noise. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/layers.hpp"

namespace hapticast::server {

/// Layers of one object over the frames. A layer has the name of the layer before that it overlaps
/// most, after the object's motion.
/// A pixel changes its name after three successive frames, or where an edge moves a little. A cut
/// stays until its step is below 0.7 of the step that caused it.
class LayerCutter {
 public:
  /// Returns the surfaces of the layers, by name; a name without pixels has an empty box. Without
  /// steps it returns `surface` alone. The first cut orders names from near to far. `mapped_range`:
  /// see findLayers().
  std::vector<Surface> cut(const Surface& surface, double step_mm,
                           const DepthRange& mapped_range = kAllDepths);

 private:
  [[nodiscard]] cv::Mat assignNames(const Surface& surface, double step_mm,
                                    const DepthRange& mapped_range);
  [[nodiscard]] cv::Mat isSettled(const Surface& surface, const cv::Mat& now,
                                  const cv::Mat& before);
  [[nodiscard]] cv::Mat warpedNames(const cv::Mat& image, const Surface& surface) const;

  cv::Mat names_;            // over the last box, CV_8UC1, 1 ..; empty for one layer
  cv::Mat pending_changes_;  // over the last box: successive frames with another name
  int count_ = 0;            // number of names; 0: no frame yet
  cv::Mat last_mask_;
  cv::Rect last_box_;
  cv::Point2d last_centroid_px_;
};

}  // namespace hapticast::server
