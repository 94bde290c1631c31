// SPDX-License-Identifier: MIT
#include "common/codec/slice/field.hpp"

#include <cstring>

namespace hapticast::codec {

namespace {

std::size_t area(std::ptrdiff_t stride, int rows) {
  return static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows);
}

/// Interpolates next to an end, from the end (`near`) and the two points beyond.
std::int32_t extrapolate(std::int32_t near, std::int32_t far, std::int32_t third) {
  return (3 * near + 6 * far - third + 4) >> 3;
}

/// Interpolates between the points of a row by four-point (cubic) interpolation.
void widen(const std::int32_t* in, std::ptrdiff_t count, std::int32_t* out) {
  if (count == 2) {
    out[0] = in[0];
    out[1] = (in[0] + in[1]) >> 1;
    out[2] = in[1];
    return;
  }
  const std::ptrdiff_t last = count - 1;
  out[0] = in[0];
  out[1] = extrapolate(in[0], in[1], in[2]);
  for (std::ptrdiff_t i = 1; i < last - 1; ++i) {
    out[2 * i] = in[i];
    out[2 * i + 1] = (9 * (in[i] + in[i + 1]) - in[i - 1] - in[i + 2] + 8) >> 4;
  }
  out[2 * last - 2] = in[last - 1];
  out[2 * last - 1] = extrapolate(in[last], in[last - 1], in[last - 2]);
  out[2 * last] = in[last];
}

}  // namespace

void Field::begin(const Shape& slice) {
  shape = slice;
  mask.stride = slice.columns * kCell_px + 2 * kMargin_px;
  pixels.assign(area(mask.stride, slice.rows * kCell_px + 2 * kMargin_px), 0);
  mask.data = pixels.data() + kMargin_px * mask.stride + kMargin_px;
}

void Field::reset(bool encodes) {
  findCells();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    Level& level = levels[i];
    level.step = 4 >> i;
    const int points = 2 << i;  // of a cell
    level.columns = shape.columns * points + 1;
    level.rows = shape.rows * points + 1;
    level.height.resize(area(level.columns, level.rows));
    level.stride = level.columns + 3;
    level.size.assign(area(level.stride, level.rows + 3), 0);
    level.sign.assign(level.size.size(), 0);
    if (encodes) level.detail.assign(level.size.size(), 0);
    level.flags.assign(occupied.size(), 0);
    level.even.clear();
    level.odd.clear();
  }
}

void Field::findCells() {
  const Shape& slice = shape;
  cell_stride = slice.columns + 2;
  occupied.assign(area(cell_stride, slice.rows + 2), 0);
  node_stride = slice.columns + 5;
  needed.assign(area(node_stride, slice.rows + 5), 0);
  base.assign(needed.size(), 0);
  for (int y = 0; y < slice.height; ++y) {
    const std::uint8_t* row = mask.data + y * mask.stride;
    for (int x = 0; x < slice.columns; ++x) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, row + std::ptrdiff_t{x} * kCell_px, sizeof eight);
      if (eight != 0) occupied[static_cast<std::size_t>(cell(x, y / kCell_px))] = 1;
    }
  }
  for (int y = 0; y <= slice.rows; ++y) {
    for (int x = 0; x <= slice.columns; ++x) {
      const std::uint8_t* at = occupied.data() + cell(x, y);
      needed[static_cast<std::size_t>(node(x, y))] =
          at[0] | at[-1] | at[-cell_stride] | at[-cell_stride - 1];
    }
  }
}

void Field::placeNodes(int step) {
  const int columns = shape.columns + 1;
  nodes.resize(area(columns, shape.rows + 1));
  for (int y = 0; y <= shape.rows; ++y) {
    for (int x = 0; x <= shape.columns; ++x) {
      const std::ptrdiff_t at = node(x, y);
      const std::uint8_t* need = needed.data() + at;
      const std::int32_t* value = base.data() + at;
      std::int32_t height = *value * step;
      if (*need == 0) {
        std::int32_t sum = 0;
        std::int32_t count = 0;
        for (const std::ptrdiff_t to :
             {std::ptrdiff_t{-1}, std::ptrdiff_t{1}, -node_stride, node_stride}) {
          if (need[to] == 0) continue;
          sum += (need[2 * to] != 0 ? 2 * value[to] - value[2 * to] : value[to]) * step;
          ++count;
        }
        height = count > 0 ? sum / count : 0;
      }
      nodes[static_cast<std::size_t>(y * columns + x)] = height;
    }
  }
}

void Field::interpolateEven(std::size_t level) {
  Level& fine = levels[level];
  const int columns = fine.columns / 2 + 1;
  const std::int32_t* in = findCoarser(level);
  for (int y = 0; y < fine.rows; y += 2, in += columns)
    widen(in, columns, fine.height.data() + std::ptrdiff_t{y} * fine.columns);
}

void Field::interpolateOdd(std::size_t level) {
  Level& fine = levels[level];
  const std::ptrdiff_t two = std::ptrdiff_t{2} * fine.columns;  // offset to the next even row
  for (int y = 1; y < fine.rows; y += 2) {
    std::int32_t* out = fine.height.data() + std::ptrdiff_t{y} * fine.columns;
    const std::int32_t* up = out - fine.columns;
    const std::int32_t* down = out + fine.columns;
    if (fine.rows == 3) {
      for (int x = 0; x < fine.columns; ++x) out[x] = (up[x] + down[x]) >> 1;
    } else if (y == 1) {
      for (int x = 0; x < fine.columns; ++x) out[x] = extrapolate(up[x], down[x], down[x + two]);
    } else if (y == fine.rows - 2) {
      for (int x = 0; x < fine.columns; ++x) out[x] = extrapolate(down[x], up[x], up[x - two]);
    } else {
      for (int x = 0; x < fine.columns; ++x)
        out[x] = (9 * (up[x] + down[x]) - up[x - two] - down[x + two] + 8) >> 4;
    }
  }
}

}  // namespace hapticast::codec
