// SPDX-License-Identifier: MIT
// Layer decomposition: splits an object at depth steps inside its mask (for example, a hand in
// front of a body). Each layer becomes a relief of its own, so that a step does not become a slope.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Finds the connected pieces of `where` with at least `smallest_px` pixels and returns their
/// number n. Writes the labels 1 .. n into `labels`; pixels outside these pieces have 0. The image
/// of labels is CV_8UC1 over the surface's box. Thread: any.
int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels);

/// Returns the mean depth of each label 1 .. count, mm; 0 for a label without pixels.
std::vector<double> meanDepths(const Surface& surface, const cv::Mat& labels, int count);

/// Returns labels for the whole mask, grown from the labels 1 .. count of `seeds` ring by ring. A
/// pixel adopts the label of that neighbour whose depth is nearest. Isolated parts adopt the label
/// of the nearest mean depth.
cv::Mat growLabels(const Surface& surface, int count, const cv::Mat& seeds);

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

/// Returns the measured pixels (CV_8UC1, 0/255) whose 3 x 3 neighbourhood has two measured depths
/// that differ by more than `step_mm`.
cv::Mat findSteps(const Surface& surface, double step_mm);

/// Splits a downsampled surface as the other findLayers() does. `surface` and `step`, the pixels at
/// depth steps (CV_8UC1, 0/255), are sampled every `reduction` px.
Layers findLayers(const Surface& surface, const cv::Mat& step, double step_mm,
                  const DepthRange& mapped_range, int reduction = 1);

}  // namespace hapticast::server
