// SPDX-License-Identifier: MIT
// Labelled pieces of a surface: connected components, and region growing from seeds. Labels:
// CV_8UC1 over the surface's box, 0: none. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Finds the connected pieces of `where` with at least `smallest_px` pixels. Writes labels 1 .. n
/// (0: no such piece) and returns n.
int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels);

/// Returns the mean depth of each label 1 .. count, mm; 0 for a label without pixels.
std::vector<double> meanDepths(const Surface& surface, const cv::Mat& labels, int count);

/// Returns `seeds` (labels 1 .. count) grown over the whole mask, ring by ring. A pixel adopts the
/// label of the neighbour nearest in depth; isolated parts adopt the label of the nearest mean
/// depth.
cv::Mat grownLabels(const Surface& surface, int count, const cv::Mat& seeds);

}  // namespace hapticast::server
