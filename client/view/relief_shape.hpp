// SPDX-License-Identifier: MIT
// Reliefs as outlines and as meshes, for drawing.
// Thread: any (pure functions).
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/relief/height_field.hpp"

namespace hapticast::client {

using Reliefs = std::vector<std::shared_ptr<const HeightField>>;

/// Returns the edges of the relief's mask as closed lines, in px of the picture.
[[nodiscard]] std::vector<std::vector<cv::Point2f>> traceOutline(const HeightField& relief);

/// A mesh of quadrilateral cells. Its brightness is that of a light from the upper left.
struct ReliefMesh {
  /// Largest number of cells of all objects together. The value is a choice: the software renderer
  /// draws them within some milliseconds.
  static constexpr double kMostCells = 4096.0;
  struct Corner {
    Vec3 position_mm;  ///< nominal
    float light;       ///< brightness, 0..1
  };
  std::vector<Corner> corners;
  /// For each cell the indices of its corners, in order around the cell.
  std::vector<std::array<int, 4>> cells;
};

/// Returns a mesh of the reliefs, inside their masks only. The more pixels the reliefs cover, the
/// larger are the cells. A cell has sides of at least `least_px` px of the picture.
[[nodiscard]] ReliefMesh buildMesh(const Reliefs& reliefs, const Workspace& workspace,
                                   int least_px = 1);

/// Returns true if `cell` is a part of a wall: its heights differ by more than twice its width. At
/// the edge of a mask, such cells are the steep sides of the object.
[[nodiscard]] bool isWall(const ReliefMesh& mesh, const std::array<int, 4>& cell);

/// Returns `mesh` without its walls, and with a smooth rim. Corners inside the rim are unchanged.
[[nodiscard]] ReliefMesh cutWalls(ReliefMesh mesh);

}  // namespace hapticast::client
