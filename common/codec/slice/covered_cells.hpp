// SPDX-License-Identifier: MIT
// Set of a relief's cells that slices cover; no two slices may cover the same cell. Thread: any,
// one for each object.
#pragma once

#include <cstddef>
#include <vector>

#include "common/codec/slice/field.hpp"
#include "common/codec/slice/header.hpp"
#include "common/codec/slice/rough.hpp"
#include "common/geometry.hpp"

namespace hapticast::codec {

/// Covered cells of one relief.
class CoveredCells {
 public:
  explicit CoveredCells(const PixelRect& rect)
      : columns_(cellsOver(rect.width)),
        covered_(static_cast<std::size_t>(columns_) *
                 static_cast<std::size_t>(cellsOver(rect.height))) {}

  /// Marks the slice's cells as covered. Returns false if one of them was covered before. Requires
  /// a slice of this rectangle.
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

// Encoder side of smooth mode: computes the base values and details (interpolation residuals) of a
// slice. Thread: any.

/// Computes base, nodes, details and flags of a field that was reset for an encoder. Every pixel
/// inside then has an error of at most half of steps.px.
void analyse(Field& field, const Surroundings& object, const Steps& steps);

/// Returns the estimated cost of a cell in bits, of an analysed field or of coded numbers.
float estimateCost(const Field& field, int cell_x, int cell_y);
float estimateCost(const Numbers& numbers, const Field& field, int cell_x, int cell_y);

}  // namespace hapticast::codec
