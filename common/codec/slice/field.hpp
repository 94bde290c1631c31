// SPDX-License-Identifier: MIT
// Interpolation pyramid of a slice, shared by encoder and decoder (proto/README.md). It has cells
// of 8 x 8 px, coarse nodes at their corners, and three levels of points between, 4, 2 and 1 px
// apart. Heights are integers of 1/4096 mm (units). Thread: one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapticast::codec {

inline constexpr int kCell_px = 8;
/// Returns the number of cells that cover `px` pixels.
constexpr int cellsOver(int px) noexcept { return (px + kCell_px - 1) / kCell_px; }
inline constexpr int kUnitsPerMm = 4096;
inline constexpr int kMargin_px = 8;               ///< around the mask, always 0
inline constexpr std::int32_t kHighest = 1 << 22;  ///< 1024 mm, either sign; units

/// Quantiser steps in units, for pixels and for coarser points.
struct Steps {
  int px = 0;
  std::array<int, 3> level{};  ///< for points 4, 2, 1 px apart
  int base = 0;                ///< for nodes

  /// Computes all steps. `px`: 9..4095. `sixteenths`: coarse step in sixteenths of `px`, 1..16.
  static Steps from(int px, int sixteenths) noexcept {
    const int coarse = std::max(1, px * sixteenths / 16);
    return {px, {std::max(1, 4 * coarse / 5), coarse, px}, std::max(1, 7 * coarse / 10)};
  }
};

/// Size of a slice.
struct Shape {
  int columns = 0, rows = 0;  ///< cells
  int width = 0, height = 0;  ///< their pixels inside the object's rectangle
};

/// Pixels (1 inside, 0 outside), with a margin of kMargin_px.
struct Mask {
  std::uint8_t* data = nullptr;  ///< the slice's first pixel
  std::ptrdiff_t stride = 0;
};

/// The object around a slice.
struct Surroundings {
  Mask mask;  ///< starts at the slice's first pixel, extends beyond the slice
  const std::int32_t* target = nullptr;  ///< heights in units, with the mask's layout
};

/// A correction of an interpolated point.
struct Patch {
  std::uint32_t point = 0;  ///< index into Level::height
  std::int32_t change = 0;
};

/// Points `step` px apart; the coarser level has those in even rows and columns.
struct Level {
  int step = 0;
  int columns = 0, rows = 0;         ///< points; the last row and column belong to the next slice
  std::vector<std::int32_t> height;  ///< columns x rows
  std::ptrdiff_t stride = 0;         ///< of `size` and `detail`, with a margin of 2 points
  std::vector<std::uint8_t> size;    ///< |detail|, at most kMostSize
  std::vector<std::uint8_t> sign;    ///< of the details: 0 none, 1 minus, 2 plus
  std::vector<std::int32_t> detail;  ///< encoder: correction of each point, in steps
  std::vector<std::uint8_t> flags;   ///< cells with a detail, laid out as Field::occupied
  std::vector<Patch> even, odd;      ///< decoder: details in even and odd rows

  [[nodiscard]] std::ptrdiff_t at(int x, int y) const { return (y + 2) * stride + x + 2; }
};
inline constexpr int kMostSize = 60;  ///< limit of Level::size

/// State of one slice.
struct Field {
  Shape shape;
  Mask mask;                           ///< 0 outside the slice
  std::vector<std::uint8_t> pixels;    ///< storage of `mask`
  std::ptrdiff_t cell_stride = 0;      ///< of occupied and flags, with a margin of one cell
  std::vector<std::uint8_t> occupied;  ///< cells with a pixel inside
  std::ptrdiff_t node_stride = 0;      ///< of needed and base, with a margin of 2 nodes
  std::vector<std::uint8_t> needed;    ///< nodes at the corners of occupied cells
  std::vector<std::int32_t> base;      ///< heights of needed nodes, in steps
  std::vector<std::int32_t> nodes;     ///< heights of all nodes, (columns + 1) x (rows + 1)
  std::array<Level, 3> levels;         ///< points 4, 2, 1 px apart

  /// Starts a slice of this shape with an empty mask.
  void begin(const Shape& slice);
  /// Prepares the other members, after the mask is complete. `encodes`: allocates details.
  void reset(bool encodes);

  /// Returns the index of a cell in occupied and flags.
  [[nodiscard]] std::ptrdiff_t cell(int x, int y) const { return (y + 1) * cell_stride + x + 1; }
  /// Returns the index of a node in needed and base.
  [[nodiscard]] std::ptrdiff_t node(int x, int y) const { return (y + 2) * node_stride + x + 2; }

  /// Computes `nodes` from `base`; nodes that are not needed are extrapolated from their
  /// neighbours.
  void placeNodes(int step);
  /// Interpolate the even rows of a level, then its odd rows, from the coarser level.
  void interpolateEven(std::size_t level);
  void interpolateOdd(std::size_t level);

 private:
  void findCells();
  [[nodiscard]] const std::int32_t* coarser(std::size_t level) const {
    return level == 0 ? nodes.data() : levels[level - 1].height.data();
  }
};

}  // namespace hapticast::codec
