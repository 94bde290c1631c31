// SPDX-License-Identifier: MIT
// Temporally consistent labels for an object's layers. Each layer has a name, a number that
// persists from frame to frame, even if the depth is noisy. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/layers.hpp"

namespace hapticast::server {

/// Splits one object into layers frame by frame, with persistent names. Each pixel has a vote for
/// each name: the share of the last 8 or so frames in which the pixel's layer had this name (a
/// running mean). The votes move with the object. A layer of this frame receives the name for which
/// its pixels have most votes. A pixel changes its name when another name leads by a third of the
/// votes. That happens after nine successive frames, or later if some frames disagree. It changes
/// at once if it is at most 2 px from pixels that had the new name, and its measured depth is
/// clearly that of the new name. Layers stay separate until the step between them is below 0.7
/// `step_mm`. A surface with a reduction is split at the reduced size.
class LayerCutter {
 public:
  /// Returns the surfaces of the layers of `surface`. Element i is the layer with the name i + 1;
  /// its box is empty if the layer has no pixels. Without depth steps it returns `surface` alone.
  /// The first call orders the names from near to far. `mapped_range`: see findLayers().
  std::vector<Surface> cut(const Surface& surface, double step_mm,
                           const DepthRange& mapped_range = kAllDepths);

 private:
  void moveTo(const Surface& surface, int reduction);
  [[nodiscard]] cv::Mat assignNames(const Surface& surface, Layers now, double step_mm);
  [[nodiscard]] cv::Mat countVotes(const Surface& surface, const cv::Mat& now, double step_mm);

  int count_ = 0;  // number of names; 0: no frame yet
  // Of the last frame at 1 / reduction_ of the size, over box_.
  int reduction_ = 1;
  cv::Rect box_;
  cv::Point2d centroid_px_;
  cv::Mat names_;  // CV_8UC1: 1 .. in the mask, 0 outside
  cv::Mat votes_;  // CV_8UC4: 0 .. 255 for each name; empty while there is one layer
};

}  // namespace hapticast::server
