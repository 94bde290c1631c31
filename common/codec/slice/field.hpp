// SPDX-License-Identifier: MIT
// What encoder and decoder both hold of a slice: cells of 8 x 8 px, the coarse nodes at their
// corners, and three levels of points between them, 4, 2 and 1 px apart (proto/README.md). Heights
// are whole numbers of 1/4096 mm. Thread: one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapticast::codec {

inline constexpr int kCell_px = 8;
/// Cells that cover so many pixels.
constexpr int cellsOver(int px) noexcept { return (px + kCell_px - 1) / kCell_px; }
inline constexpr int kUnitsPerMm = 4096;
inline constexpr int kMargin_px = 8;               ///< around the mask, always 0
inline constexpr std::int32_t kHighest = 1 << 22;  ///< 1024 mm, either sign

/// Quantiser steps in units: of pixels, and of what is coarser.
struct Steps {
  int px = 0;
  std::array<int, 3> level{};  ///< of points 4, 2, 1 px apart
  int base = 0;

  /// `px`: 9..4095; `sixteenths`: the coarse step is so many of px, 1..16.
  static Steps from(int px, int sixteenths) noexcept {
    const int coarse = std::max(1, px * sixteenths / 16);
    return {px, {std::max(1, 4 * coarse / 5), coarse, px}, std::max(1, 7 * coarse / 10)};
  }
};

/// Size of a slice.
struct Shape {
  int columns = 0, rows = 0;  ///< cells
  int width = 0, height = 0;  ///< pixels of them that lie in the object's rectangle
};

/// Pixels (1 inside, 0 outside), with kMargin_px around them.
struct Mask {
  std::uint8_t* data = nullptr;  ///< of the slice's first pixel
  std::ptrdiff_t stride = 0;
};

/// The object around a slice.
struct Surroundings {
  Mask mask;                             ///< of the slice's first pixel, goes on beyond the slice
  const std::int32_t* target = nullptr;  ///< heights in units, laid out as the mask
};

/// A change of a point that was interpolated.
struct Patch {
  std::uint32_t point = 0;  ///< in Level::height
  std::int32_t change = 0;
};

/// Points `step` px apart; those of every other row and column are the coarser level's.
struct Level {
  int step = 0;
  int columns = 0, rows = 0;         ///< points; the last of each belong to the next slice
  std::vector<std::int32_t> height;  ///< columns x rows
  std::ptrdiff_t stride = 0;         ///< of `size` and `detail`, which have 2 points around them
  std::vector<std::uint8_t> size;    ///< |detail|, at most kMostSize
  std::vector<std::uint8_t> sign;    ///< of the details: 0 none, 1 minus, 2 plus
  std::vector<std::int32_t> detail;  ///< encoder: what is added to each point, in steps
  std::vector<std::uint8_t> flags;   ///< as Field::occupied: cells with any detail
  std::vector<Patch> even, odd;      ///< decoder: details by the rows they stand in

  [[nodiscard]] std::ptrdiff_t at(int x, int y) const { return (y + 2) * stride + x + 2; }
};
inline constexpr int kMostSize = 60;

struct Field {
  Shape shape;
  Mask mask;                           ///< 0 outside the slice
  std::vector<std::uint8_t> pixels;    ///< what `mask` shows
  std::ptrdiff_t cell_stride = 0;      ///< of occupied and flags, which have a cell around them
  std::vector<std::uint8_t> occupied;  ///< cells that hold a pixel
  std::ptrdiff_t node_stride = 0;      ///< of needed and base, which have 2 nodes around them
  std::vector<std::uint8_t> needed;    ///< nodes at the corners of occupied cells
  std::vector<std::int32_t> base;      ///< their heights, in steps
  std::vector<std::int32_t> nodes;     ///< heights of all nodes, (columns + 1) x (rows + 1)
  std::array<Level, 3> levels;         ///< 4, 2, 1 px

  /// An empty mask for a slice of this shape.
  void begin(const Shape& slice);
  /// The rest, when the mask is complete. `encodes`: details have a place.
  void reset(bool encodes);

  [[nodiscard]] std::ptrdiff_t cell(int x, int y) const { return (y + 1) * cell_stride + x + 1; }
  [[nodiscard]] std::ptrdiff_t node(int x, int y) const { return (y + 2) * node_stride + x + 2; }

  /// From `base` to `nodes`: those that nobody needs continue their neighbours.
  void placeNodes(int step);
  /// The heights of a level's even rows, and then of its odd ones, between the coarser level's.
  void interpolateEven(std::size_t level);
  void interpolateOdd(std::size_t level);

 private:
  void findCells();
  [[nodiscard]] const std::int32_t* coarser(std::size_t level) const {
    return level == 0 ? nodes.data() : levels[level - 1].height.data();
  }
};

}  // namespace hapticast::codec
