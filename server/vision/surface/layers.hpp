// SPDX-License-Identifier: MIT
// Layer decomposition: splits an object at depth steps inside its mask (for example, a hand in
// front of a body). Each layer becomes a relief of its own, so that a step does not become a slope.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

// Labelled pieces of a surface: connected components, and regions that grow from seeds. An image of
// labels is CV_8UC1 over the surface's box; 0 means no label. Thread: any.

/// Finds the connected pieces of `where` with at least `smallest_px` pixels and returns their
/// number n. Writes the labels 1 .. n into `labels`; pixels outside these pieces have 0.
int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels);

/// Returns the mean depth of each label 1 .. count, mm; 0 for a label without pixels.
std::vector<double> meanDepths(const Surface& surface, const cv::Mat& labels, int count);

/// Returns labels for the whole mask, grown from the labels 1 .. count of `seeds` ring by ring. A
/// pixel adopts the label of that neighbour whose depth is nearest. Isolated parts adopt the label
/// of the nearest mean depth.
cv::Mat grownLabels(const Surface& surface, int count, const cv::Mat& seeds);

inline constexpr int kMaxLayers = 4;  ///< largest number of layers of an object
inline constexpr DepthRange kAllDepths{0.0, 1e9};

/// Layers into which an object is split.
struct Layers {
  int count = 1;
  /// CV_8UC1 over the surface's box: 0 outside, n + 1 in layer n; empty for one layer.
  cv::Mat labels;
};

/// Splits `surface` at depth steps. Two pieces are separate if their measured depths differ by more
/// than `step_mm` along their common border. Returns at most kMaxLayers layers. A piece that lies
/// behind a piece beside it belongs to a farther layer. Pieces that do not touch may share a layer.
/// Pieces smaller than 100 px, or than 2 % of the object, join their neighbours. `mapped_range`:
/// depths outside this range are clamped to it before the comparison, so a step that lies outside
/// the range does not count.
Layers findLayers(const Surface& surface, double step_mm,
                  const DepthRange& mapped_range = kAllDepths);

// Temporal consistency of an object's layers: each layer has a name (a number) that persists from
// frame to frame, even if the depth is noisy. Thread: the one that runs Vision.

/// Splits one object into layers frame by frame, with persistent names. The layers of the last
/// frame are moved with the object. A layer has the name of that moved layer with which it shares
/// most pixels. A pixel changes its name after it had another one in three successive frames. It
/// changes at once if it is at most 2 px from pixels that had the new name. Layers stay separate
/// until the step between them is below 0.7 `step_mm`.
class LayerCutter {
 public:
  /// Returns the surfaces of the layers of `surface`. Element i is the layer with the name i + 1;
  /// its box is empty if the layer has no pixels. Without depth steps it returns `surface` alone.
  /// The first call orders the names from near to far. `mapped_range`: see findLayers().
  std::vector<Surface> cut(const Surface& surface, double step_mm,
                           const DepthRange& mapped_range = kAllDepths);

 private:
  [[nodiscard]] cv::Mat assignNames(const Surface& surface, double step_mm,
                                    const DepthRange& mapped_range);
  [[nodiscard]] cv::Mat isSettled(const Surface& surface, const cv::Mat& now,
                                  const cv::Mat& before);
  [[nodiscard]] cv::Mat warpedNames(const cv::Mat& image, const Surface& surface) const;

  cv::Mat names_;  // names over the last box, CV_8UC1, 1 ..; empty for one layer
  // Over the last box: for how many successive frames a pixel has had another name.
  cv::Mat pending_changes_;
  int count_ = 0;  // number of names; 0: no frame yet
  cv::Mat last_mask_;
  cv::Rect last_box_;
  cv::Point2d last_centroid_px_;
};

}  // namespace hapticast::server
