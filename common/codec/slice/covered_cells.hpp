// SPDX-License-Identifier: MIT
// Set of the cells that the slices of a relief cover. No two slices may cover the same cell, so the
// set detects slices that overlap. Thread: any; at most one at a time for each object.
#pragma once

#include <cstddef>
#include <vector>

#include "common/codec/slice/field.hpp"
#include "common/codec/slice/header.hpp"
#include "common/codec/slice/rough.hpp"
#include "common/geometry.hpp"

namespace hapticast::codec {

/// The set of cells that the slices of one relief cover.
class CoveredCells {
 public:
  explicit CoveredCells(const PixelRect& rect)
      : columns_(countCells(rect.width)),
        covered_(static_cast<std::size_t>(columns_) *
                 static_cast<std::size_t>(countCells(rect.height))) {}

  /// Marks the cells of the slice with this header as covered. Returns false if an earlier slice
  /// covers one of these cells. Requires a slice of this relief.
  bool claim(const Header& slice) {
    bool free = true;
    for (int y = slice.y; y < slice.y + slice.rows; ++y) {
      for (int x = slice.x; x < slice.x + slice.columns; ++x) {
        std::vector<bool>::reference cell = covered_[static_cast<std::size_t>(y * columns_ + x)];
        free = free && !cell;
        cell = true;
      }
    }
    return free;
  }

 private:
  int columns_;
  std::vector<bool> covered_;
};

/// Computes the base heights, nodes, details and flags of `field`. Requires a field after
/// reset(true). `object` has the heights to code. Afterwards every pixel inside the mask has an
/// error of at most half of steps.px. A detail is the difference between a point and its
/// interpolation. Used by the encoder only (smooth mode). Thread: any.
void analyse(Field& field, const Surroundings& object, const Steps& steps);

/// Return the estimated number of bits of one cell. The first function is for smooth mode, and it
/// needs a field after analyse(). The second one is for rough mode, and it needs the level indices
/// `numbers`.
float estimateCost(const Field& field, int cell_x, int cell_y);
float estimateCost(const Numbers& numbers, const Field& field, int cell_x, int cell_y);

}  // namespace hapticast::codec
