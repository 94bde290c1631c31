// SPDX-License-Identifier: MIT
// Reliefs as lines and triangles to be drawn. Thread: any.
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/relief/height_field.hpp"

namespace hapticast::client {

using Reliefs = std::vector<std::shared_ptr<const HeightField>>;

/// The edges of the mask as closed lines, px of the picture.
[[nodiscard]] std::vector<std::vector<cv::Point2f>> traceOutline(const HeightField& relief);

/// A surface of four-cornered cells, lit from the upper left.
struct ReliefMesh {
  /// Chosen: of all objects together; the software renderer draws them in some milliseconds.
  static constexpr double kMostCells = 4096.0;
  struct Corner {
    Vec3 position_mm;  ///< nominal
    float light;       ///< 0..1
  };
  std::vector<Corner> corners;
  std::vector<std::array<int, 4>> cells;  ///< their corners, in a round
};

/// What lies within the masks, coarser the larger it is; a cell has at least `least_px` px of the
/// picture.
[[nodiscard]] ReliefMesh buildMesh(const Reliefs& reliefs, const Workspace& workspace,
                                   int least_px = 1);

}  // namespace hapticast::client
