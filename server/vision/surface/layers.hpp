// SPDX-License-Identifier: MIT
// Layer decomposition: splits an object at depth steps inside its mask (for example, a hand in
// front of a body). Each layer is a relief of its own, so that a gap does not become a slope.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

// Labelled pieces of a surface: connected components, and region growing from seeds. Labels:
// CV_8UC1 over the surface's box, 0: none. Thread: any.

/// Finds the connected pieces of `where` with at least `smallest_px` pixels. Writes labels 1 .. n
/// (0: no such piece) and returns n.
int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels);

/// Returns the mean depth of each label 1 .. count, mm; 0 for a label without pixels.
std::vector<double> meanDepths(const Surface& surface, const cv::Mat& labels, int count);

/// Returns `seeds` (labels 1 .. count) grown over the whole mask, ring by ring. A pixel adopts the
/// label of the neighbour nearest in depth; isolated parts adopt the label of the nearest mean
/// depth.
cv::Mat grownLabels(const Surface& surface, int count, const cv::Mat& seeds);

inline constexpr int kMaxLayers = 4;  ///< largest number of layers of an object
inline constexpr DepthRange kAllDepths{0.0, 1e9};

/// Layers of an object.
struct Layers {
  int count = 1;
  /// CV_8UC1 over the surface's box: 0 outside, n + 1 in layer n; empty for one layer.
  cv::Mat labels;
};

/// Splits `surface` into the pieces whose measured depth steps by more than `step_mm` (working
/// depth) along their common border. Returns at most kMaxLayers layers.
/// A piece behind another one is a layer behind it; pieces that do not touch share a layer. Pieces
/// of less than 100 px or 2 % of the object join their neighbours.
/// `mapped_range`: depths that map to different heights. Depths beyond it clamp to its ends, so a
/// step there does not count.
Layers findLayers(const Surface& surface, double step_mm,
                  const DepthRange& mapped_range = kAllDepths);

// Temporal consistency of an object's layers: names persist from frame to frame, with hysteresis
// against noise. Thread: the one that runs Vision.

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
