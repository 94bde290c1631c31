// SPDX-License-Identifier: MIT
#include "common/codec/slice/covered_cells.hpp"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace hapticast::codec {

namespace {

constexpr int kReach_px = 8;  // search range of a node outside the mask
constexpr int kAcross = 20;   // 2 kReach_px + 1, padded for vectorisation

/// Weights 1/(1 + r²)² of the pixels around a node, and their products with x and x².
struct Weights {
  using Row = std::array<float, kAcross>;
  std::array<Row, kReach_px + 1> one{}, x{}, xx{};

  Weights() {
    for (int y = 0; y <= kReach_px; ++y) {
      for (int x = -kReach_px; x <= kReach_px; ++x) {
        const auto i = static_cast<std::size_t>(x + kReach_px);
        const auto row = static_cast<std::size_t>(y);
        const auto place = static_cast<float>(x);
        const auto far = static_cast<float>(1 + x * x + y * y);
        one[row][i] = 1.0F / (far * far);
        this->x[row][i] = one[row][i] * place;
        xx[row][i] = this->x[row][i] * place;
      }
    }
  }
};

/// Sums over the pixels around a node: weights, positions, heights and their products.
struct Moments {
  double one = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, h = 0, xh = 0, yh = 0;
};

/// Sums of one row of pixels.
struct RowMoments {
  float one = 0, x = 0, xx = 0, h = 0, xh = 0;
};

RowMoments momentsOfRow(const Weights& weights, std::size_t row, const std::uint8_t* mask,
                        const std::int32_t* target) {
  std::array<Weights::Row, 5> part{};
  for (std::size_t i = 0; i < kAcross; ++i) {  // the weights beyond 2 kReach_px are 0
    const auto inside = static_cast<float>(mask[i]);
    const float height = inside * static_cast<float>(target[i]);
    part[0][i] = weights.one[row][i] * inside;
    part[1][i] = weights.x[row][i] * inside;
    part[2][i] = weights.xx[row][i] * inside;
    part[3][i] = weights.one[row][i] * height;
    part[4][i] = weights.x[row][i] * height;
  }
  std::array<float, 5> sum{};
  for (std::size_t k = 0; k < 5; ++k) {
    std::array<float, 4> four{};
    for (std::size_t i = 0; i < kAcross; ++i) four[i % 4] += part[k][i];
    sum[k] = (four[0] + four[1]) + (four[2] + four[3]);
  }
  return {sum[0], sum[1], sum[2], sum[3], sum[4]};
}

/// Returns the height outside the mask from a weighted plane through the pixels around the
/// position.
std::int32_t continueTarget(const Mask& mask, const std::int32_t* target, int u, int v) {
  static const Weights kWeights;
  Moments sum;
  for (int y = -kReach_px; y <= kReach_px; ++y) {
    const std::ptrdiff_t at = std::ptrdiff_t{v + y} * mask.stride + u - kReach_px;
    std::array<std::uint64_t, 2> most{};
    std::memcpy(most.data(), mask.data + at, sizeof most);
    if ((most[0] | most[1] | mask.data[at + std::ptrdiff_t{2} * kReach_px]) == 0) continue;
    const RowMoments row =
        momentsOfRow(kWeights, static_cast<std::size_t>(std::abs(y)), mask.data + at, target + at);
    sum.one += row.one;
    sum.x += row.x;
    sum.y += row.one * static_cast<float>(y);
    sum.xx += row.xx;
    sum.xy += row.x * static_cast<float>(y);
    sum.yy += row.one * static_cast<float>(y * y);
    sum.h += row.h;
    sum.xh += row.xh;
    sum.yh += row.h * static_cast<float>(y);
  }
  if (sum.one <= 0.0) return 0;
  constexpr double kBlur_px2 = 0.3;  // regularises the slope of few pixels
  const double x = sum.x / sum.one;
  const double y = sum.y / sum.one;
  const double h = sum.h / sum.one;
  const double xx = sum.xx / sum.one - x * x + kBlur_px2;
  const double yy = sum.yy / sum.one - y * y + kBlur_px2;
  const double xy = sum.xy / sum.one - x * y;
  const double xh = sum.xh / sum.one - x * h;
  const double yh = sum.yh / sum.one - y * h;
  const double det = xx * yy - xy * xy;
  const double plane = h - ((xh * yy - yh * xy) * x + (yh * xx - xh * xy) * y) / det;
  return static_cast<std::int32_t>(
      std::lround(std::clamp(plane, -10.0 * kUnitsPerMm, double{kHighest})));
}

/// Returns `rest` in steps, rounded; the error is at most half a step.
std::int32_t countSteps(std::int32_t rest, std::int32_t step, float per_step) {
  const float exact = static_cast<float>(rest) * per_step;
  auto out = static_cast<std::int32_t>(exact + (rest < 0 ? -0.499F : 0.499F));
  const std::int32_t twice = 2 * (rest - out * step);
  out += (twice > step ? 1 : 0) - (twice < -step ? 1 : 0);
  return out;
}

void analyseBase(Field& field, const Surroundings& object, const Steps& steps) {
  const Mask& mask = object.mask;
  for (int y = 0; y <= field.shape.rows; ++y) {
    for (int x = 0; x <= field.shape.columns; ++x) {
      const auto at = static_cast<std::size_t>(field.node(x, y));
      if (field.needed[at] == 0) continue;
      const std::ptrdiff_t px =
          std::ptrdiff_t{y} * kCell_px * mask.stride + std::ptrdiff_t{x} * kCell_px;
      const bool inside = mask.data[px] != 0;  // also inside the next slice
      const std::int32_t height =
          inside ? object.target[px]
                 : continueTarget(mask, object.target, x * kCell_px, y * kCell_px);
      field.base[at] = countSteps(height, steps.base, 1.0F / static_cast<float>(steps.base));
    }
  }
}

struct Row {
  std::int32_t* height;
  std::int32_t* detail;
  const std::int32_t* target;
  const std::uint8_t* mask;
};

/// Corrects the points first, first + Every, ... below `count`; their pixels are Px apart.
template <int Every, int Px>
void correct(const Row& row, int first, int count, std::int32_t step) {
  const float per_step = 1.0F / static_cast<float>(step);
  for (std::ptrdiff_t x = first; x < count; x += Every) {
    const std::int32_t inside = row.mask[Px * x];
    const std::int32_t change =
        countSteps((row.target[Px * x] - row.height[x]) * inside, step, per_step);
    row.detail[x] = change;
    row.height[x] += change * step;
  }
}

template <int Px>
void correctRows(const Surroundings& object, Level& level, int first, std::int32_t step) {
  for (int y = first; y < level.rows - 1; y += 2) {
    const std::ptrdiff_t px = std::ptrdiff_t{Px} * y * object.mask.stride;
    const Row row{level.height.data() + std::ptrdiff_t{y} * level.columns,
                  level.detail.data() + level.at(0, y), object.target + px, object.mask.data + px};
    if (first == 0)
      correct<2, Px>(row, 1, level.columns - 1, step);
    else
      correct<1, Px>(row, 0, level.columns - 1, step);
  }
}

template <std::size_t I>
void analyseLevel(Field& field, const Surroundings& object, const Steps& steps) {
  Level& level = field.levels[I];
  field.interpolateEven(I);
  correctRows<(4 >> I)>(object, level, 0, steps.level[I]);
  field.interpolateOdd(I);
  correctRows<(4 >> I)>(object, level, 1, steps.level[I]);
  const int points = kCell_px / level.step;
  for (int y = 0; y < level.rows - 1; ++y) {
    const std::int32_t* row = level.detail.data() + level.at(0, y);
    std::uint8_t* flag = level.flags.data() + field.cell(0, y / points);
    for (int x = 0; x < field.shape.columns; ++x, row += points) {
      std::int32_t any = 0;
      for (int i = 0; i < points; ++i) any |= row[i];
      flag[x] |= any != 0 ? 1 : 0;
    }
  }
}

float countBits(unsigned size) {
  return size == 0 ? 0.4F : 1.0F + 2.0F * static_cast<float>(std::bit_width(size));
}

}  // namespace

void analyse(Field& field, const Surroundings& object, const Steps& steps) {
  analyseBase(field, object, steps);
  field.placeNodes(steps.base);
  analyseLevel<0>(field, object, steps);
  analyseLevel<1>(field, object, steps);
  analyseLevel<2>(field, object, steps);
}

float estimateCost(const Numbers& numbers, const Field& field, int cell_x, int cell_y) {
  float bits = 0.0F;
  const int right = std::min((cell_x + 1) * kCell_px, field.shape.width);
  const int bottom = std::min((cell_y + 1) * kCell_px, field.shape.height);
  for (int y = cell_y * kCell_px; y < bottom; ++y) {
    for (int x = cell_x * kCell_px; x < right; ++x) {
      if (field.mask.data[y * field.mask.stride + x] == 0) continue;
      bits += countBits(numbers.rest[static_cast<std::size_t>(numbers.at(x, y))]);
    }
  }
  return bits;
}

float estimateCost(const Field& field, int cell_x, int cell_y) {
  const auto at = static_cast<std::size_t>(field.cell(cell_x, cell_y));
  if (field.occupied[at] == 0) return 0.0F;
  float bits = 6.0F;  // mask and base
  for (const Level& level : field.levels) {
    if (level.step < 4 && level.flags[at] == 0) continue;
    const int points = kCell_px / level.step;
    for (int y = 0; y < points; ++y) {
      const std::int32_t* row =
          level.detail.data() + level.at(cell_x * points, cell_y * points + y);
      for (int x = 0; x < points; ++x) bits += countBits(static_cast<unsigned>(std::abs(row[x])));
    }
  }
  return bits;
}

}  // namespace hapticast::codec
