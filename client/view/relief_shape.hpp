// SPDX-License-Identifier: MIT
// Reliefs as outlines and meshes for drawing.
// Thread: any (pure functions).
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/relief/height_field.hpp"

namespace hapticast::client {

using Reliefs = std::vector<std::shared_ptr<const HeightField>>;

/// Returns the edges of the mask as closed lines, px of the picture.
[[nodiscard]] std::vector<std::vector<cv::Point2f>> traceOutline(const HeightField& relief);

/// A mesh of quadrilateral cells, lit from the upper left.
struct ReliefMesh {
  /// Limit for all objects together. Chosen: the software renderer draws them within some
  /// milliseconds.
  static constexpr double kMostCells = 4096.0;
  struct Corner {
    Vec3 position_mm;  ///< nominal
    float light;       ///< 0..1
  };
  std::vector<Corner> corners;
  std::vector<std::array<int, 4>> cells;  ///< indices of their corners, in order around the cell
};

/// Returns the mesh of the parts within the masks. Larger reliefs have coarser cells. A cell has at
/// least `least_px` px of the picture.
[[nodiscard]] ReliefMesh buildMesh(const Reliefs& reliefs, const Workspace& workspace,
                                   int least_px = 1);

}  // namespace hapticast::client
