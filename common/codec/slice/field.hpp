// SPDX-License-Identifier: MIT
// Interpolation pyramid of a slice, for encoder and decoder (proto/slices.md). A slice has cells of
// 8 x 8 px. Nodes are the coarsest points, at the corners of the cells. Between them are three
// levels of points, which are 4, 2 and 1 px apart. Each level is interpolated from the coarser one.
// A detail is the difference between a point and its interpolation. Heights are integers in units
// of 1/4096 mm. Thread: one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapticast::codec {

inline constexpr int kCell_px = 8;
/// Returns the number of cells that cover `px` pixels.
constexpr int countCells(int px) noexcept { return (px + kCell_px - 1) / kCell_px; }
inline constexpr int kUnitsPerMm = 4096;
inline constexpr int kMargin_px = 8;  ///< width of the margin of zeros around a mask
/// Largest magnitude of a height: 1024 mm, in units.
inline constexpr std::int32_t kHighest = 1 << 22;

/// Quantiser steps of the nodes and of each level of the pyramid, in units of 1/4096 mm.
struct Steps {
  int px = 0;
  std::array<int, 3> level{};  ///< steps of the three levels, whose points are 4, 2 and 1 px apart
  int base = 0;                ///< step of the nodes

  /// Returns all steps. `px` is the step of the pixels, 9..4095. `sixteenths` is the step of the
  /// coarser points in sixteenths of `px`, 1..16.
  static Steps from(int px, int sixteenths) noexcept {
    const int coarse = std::max(1, px * sixteenths / 16);
    return {px, {std::max(1, 4 * coarse / 5), coarse, px}, std::max(1, 7 * coarse / 10)};
  }
};

/// Size of a slice.
struct Shape {
  int columns = 0, rows = 0;  ///< size in cells
  /// Size in px of the part of these cells inside the object's rectangle.
  int width = 0, height = 0;
};

/// Mask of a slice: 1 inside, 0 outside. It has a margin of kMargin_px.
struct Mask {
  std::uint8_t* data = nullptr;  ///< first pixel of the slice
  std::ptrdiff_t stride = 0;
};

/// Mask and heights of an object, as the encoder of one slice reads them. They include pixels
/// around the slice.
struct Surroundings {
  Mask mask;  ///< begins at the slice's first pixel and extends beyond the slice
  const std::int32_t* target = nullptr;  ///< heights in units, in the same order as the mask
};

/// A correction of an interpolated height.
struct Patch {
  std::uint32_t point = 0;  ///< index into Level::height
  std::int32_t change = 0;
};

/// One level of the pyramid. Its points are `step` px apart. The points in even rows and even
/// columns belong to the coarser level.
struct Level {
  int step = 0;
  /// Number of points; the last row and column belong to the next slice.
  int columns = 0, rows = 0;
  std::vector<std::int32_t> height;  ///< columns x rows
  std::ptrdiff_t stride = 0;  ///< length of a row of `size` and `detail`, with a margin of 2 points
  std::vector<std::uint8_t> size;    ///< |detail|, at most kMostSize
  std::vector<std::uint8_t> sign;    ///< sign of each detail: 0 none, 1 minus, 2 plus
  std::vector<std::int32_t> detail;  ///< encoder only: correction of each point, in steps
  std::vector<std::uint8_t> flags;   ///< 1 for cells with a detail, in the order of Field::occupied
  std::vector<Patch> even, odd;      ///< decoder only: corrections in even and odd rows

  [[nodiscard]] std::ptrdiff_t at(int x, int y) const { return (y + 2) * stride + x + 2; }
};
inline constexpr int kMostSize = 60;  ///< largest value in Level::size

/// The pyramid of one slice.
struct Field {
  Shape shape;
  Mask mask;                         ///< mask of the slice, 0 outside the slice
  std::vector<std::uint8_t> pixels;  ///< storage of `mask`
  /// Length of a row of `occupied` and `flags`, with a margin of one cell.
  std::ptrdiff_t cell_stride = 0;
  std::vector<std::uint8_t> occupied;  ///< 1 for cells with a pixel inside the mask
  /// Length of a row of `needed` and `base`, with a margin of 2 nodes.
  std::ptrdiff_t node_stride = 0;
  std::vector<std::uint8_t> needed;  ///< 1 for nodes at the corners of occupied cells
  std::vector<std::int32_t> base;    ///< heights of the needed nodes, in steps
  std::vector<std::int32_t> nodes;   ///< heights of all nodes, (columns + 1) x (rows + 1)
  std::array<Level, 3> levels;       ///< the levels with points 4, 2 and 1 px apart

  /// Begins a slice of the shape `slice` with an empty mask.
  void begin(const Shape& slice);
  /// Prepares all other members. Call reset() when the mask is complete. If `encodes` is true, the
  /// call also allocates the details of an encoder.
  void reset(bool encodes);

  /// Returns the index of a cell in `occupied` and `flags`.
  [[nodiscard]] std::ptrdiff_t cell(int x, int y) const { return (y + 1) * cell_stride + x + 1; }
  /// Returns the index of a node in `needed` and `base`.
  [[nodiscard]] std::ptrdiff_t node(int x, int y) const { return (y + 2) * node_stride + x + 2; }

  /// Computes `nodes` from `base`, which is in units of `step`. Nodes that are not needed are
  /// extrapolated from their neighbours.
  void placeNodes(int step);
  /// Interpolate a level from the coarser level. Call the function for the even rows first, then
  /// that for the odd rows.
  void interpolateEven(std::size_t level);
  void interpolateOdd(std::size_t level);

 private:
  void findCells();
  [[nodiscard]] const std::int32_t* findCoarser(std::size_t level) const {
    return level == 0 ? nodes.data() : levels[level - 1].height.data();
  }
};

}  // namespace hapticast::codec
