// SPDX-License-Identifier: MIT
// Entropy coding of smooth mode. It defines the order in which the numbers of a slice are coded:
// first the nodes, then the details of each level. It also selects the probability model of each
// number by the numbers around it. One template encodes and decodes (range_coder.hpp). Thread: any.
#pragma once

#include <array>
#include <cstdlib>

#include "common/codec/slice/field.hpp"
#include "common/codec/slice/range_coder.hpp"

namespace hapticast::codec {

/// Class (0..4) of the model for a point. The index is the sum of the sizes of the details around
/// the point.
inline constexpr auto kDetailClass = [] {
  std::array<std::uint8_t, 6 * kMostSize + 1> out{};
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint8_t>(i < 3 ? i : i < 7 ? 3 : 4);
  return out;
}();

/// Probability models of smooth mode.
struct SymbolModels {
  std::array<NumberModel, 4> base;
  /// Models of one level. The first index of each array is 0 for even rows and 1 for odd rows.
  struct Details {
    std::array<std::array<NumberModel, 5>, 2> number;  ///< second index: kDetailClass
    std::array<std::array<PlaceModel, 12>, 2> place;   ///< second index: pixelIndex()
    std::array<std::array<BitModel, 9>, 2> sign;       ///< second index: signClass()
  };
  std::array<Details, 3> detail;
  std::array<std::array<std::array<BitModel, 3>, 2>, 3> flag;
};

/// Encodes or decodes the base heights of the nodes. Each is predicted from the nodes to the left
/// and above.
template <class Coder>
void codeBase(Coder& coder, SymbolModels& models, Field& field, const Steps& steps) {
  constexpr int kMostResidual = 64;
  const std::int32_t most = kHighest / steps.base + 1;
  std::vector<std::int32_t> residuals(field.base.size(), 0);
  for (int y = 0; y <= field.shape.rows; ++y) {
    for (int x = 0; x <= field.shape.columns; ++x) {
      const std::ptrdiff_t at = field.node(x, y);
      const std::ptrdiff_t up = at - field.node_stride;
      const std::uint8_t* need = field.needed.data();
      std::int32_t* value = field.base.data();
      if (need[at] == 0) continue;
      std::int32_t guess = 0;
      if (need[at - 1] != 0 && need[up] != 0 && need[up - 1] != 0)
        guess = value[at - 1] + value[up] - value[up - 1];
      else if (need[at - 1] != 0)
        guess = value[at - 1];
      else if (need[up] != 0)
        guess = value[up];
      else if (need[up + 1] != 0)
        guess = value[up + 1];
      std::int32_t* residual = residuals.data();
      const int around = residual[at - 1] + residual[up];
      NumberModel& model = models.base[around < 2 ? 0 : around < 8 ? 1 : around < 32 ? 2 : 3];
      const std::int32_t rest = codeNumber(coder, model, value[at] - guess);
      residual[at] = std::min(std::abs(rest), kMostResidual);
      if constexpr (Coder::kDecodes) value[at] = std::clamp(guess + rest, -most, most);
    }
  }
}

/// Returns the class (0..11) of the additional model for a point of level I. The class depends on
/// three facts: whether the mask's edge is nearby, whether the point is in the middle of four
/// coarser points, and how large the details of the coarser level around it are.
template <std::size_t I>
std::size_t pixelIndex(const Field& field, const std::uint8_t* mask, int x, int y) {
  constexpr std::ptrdiff_t kPx = 4 >> I;
  const std::ptrdiff_t down = kPx * field.mask.stride;
  const bool inner = (mask[-kPx] & mask[kPx] & mask[-down] & mask[down]) != 0;
  std::size_t busy = 0;
  if constexpr (I > 0) {
    const Level& level = field.levels[I - 1];
    const std::uint8_t* size = level.size.data() + level.at(x / 2, y / 2);
    const int sum = size[0] + size[1] + size[level.stride] + size[level.stride + 1];
    busy = sum == 0 ? 0 : sum < 3 ? 1 : 2;
  }
  return (inner ? 0U : 6U) + ((x & y & 1) != 0 ? 3U : 0U) + busy;
}

/// Returns the context (0..8) for coding the sign of a detail coefficient:
/// 3 x sign to the left + sign above.
inline std::size_t signClass(const std::uint8_t* sign, std::ptrdiff_t stride) {
  const unsigned left = sign[-1] != 0 ? sign[-1] : sign[-2];
  const unsigned up = sign[-stride] != 0 ? sign[-stride] : sign[-2 * stride];
  return left * 3 + up;
}

/// Encodes or decodes the detail of one point of level I. `mask` points to the pixel of the point.
template <std::size_t I, class Coder>
void codePoint(Coder& coder, SymbolModels::Details& models, Field& field, const std::uint8_t* mask,
               int x, int y, int step) {
  Level& level = field.levels[I];
  const std::ptrdiff_t stride = level.stride;
  const std::ptrdiff_t at = level.at(x, y);
  std::uint8_t* size = level.size.data() + at;
  const int around = size[-1] + size[-2] + size[-stride] + size[-2 * stride] + size[-stride - 1] +
                     size[-stride + 1];
  const auto row = static_cast<std::size_t>(y & 1);
  NumberModel& number = models.number[row][kDetailClass[static_cast<std::size_t>(around)]];
  PlaceModel& place = models.place[row][pixelIndex<I>(field, mask, x, y)];
  const std::int32_t wanted = Coder::kDecodes ? 0 : level.detail[static_cast<std::size_t>(at)];
  if (!coder.bit(number.zero, place.zero, wanted != 0)) return;
  std::uint8_t* sign = level.sign.data() + at;
  const bool minus = coder.bit(models.sign[row][signClass(sign, stride)], wanted < 0);
  const std::int32_t value = codeMagnitude(coder, number, &place, std::abs(wanted));
  *size = static_cast<std::uint8_t>(std::min(value, kMostSize));
  *sign = minus ? 1 : 2;
  if constexpr (Coder::kDecodes) {
    const std::int32_t change = std::min(value, (1 << 25) / step) * step;
    auto& patches = row == 0 ? level.even : level.odd;
    patches.push_back(
        {static_cast<std::uint32_t>(y * level.columns + x), minus ? -change : change});
  }
}

/// Encodes or decodes the details of one cell of level I. Omits points outside the mask, and points
/// of the coarser level (even rows and columns).
template <std::size_t I, class Coder>
void codeCell(Coder& coder, SymbolModels& models, Field& field, int cell_x, int cell_y, int step) {
  constexpr int kPx = 4 >> I;
  constexpr int kPoints = kCell_px / kPx;
  const std::uint8_t* mask = field.mask.data +
                             std::ptrdiff_t{cell_y} * kCell_px * field.mask.stride +
                             std::ptrdiff_t{cell_x} * kCell_px;
  for (int y = 0; y < kPoints; ++y) {
    for (int x = (y & 1) ^ 1; x < kPoints; x += 2 - (y & 1)) {
      const std::uint8_t* inside =
          mask + std::ptrdiff_t{y} * kPx * field.mask.stride + std::ptrdiff_t{x} * kPx;
      if (*inside == 0) continue;
      codePoint<I>(coder, models.detail[I], field, inside, cell_x * kPoints + x,
                   cell_y * kPoints + y, step);
    }
  }
}

/// Encodes or decodes the details of level I, cell by cell.
template <std::size_t I, class Coder>
void codeLevel(Coder& coder, SymbolModels& models, Field& field, const Steps& steps) {
  Level& level = field.levels[I];
  for (int y = 0; y < field.shape.rows; ++y) {
    for (int x = 0; x < field.shape.columns; ++x) {
      const auto at = static_cast<std::size_t>(field.cell(x, y));
      if (field.occupied[at] == 0) continue;
      if constexpr (I > 0) {
        const std::size_t before = I == 2 ? field.levels[1].flags[at] : 0;
        std::uint8_t* flag = level.flags.data() + at;
        const int around = flag[-1] + flag[-field.cell_stride];
        BitModel& model = models.flag[I][before][static_cast<std::size_t>(around)];
        *flag = coder.bit(model, *flag != 0) ? 1 : 0;
        if (*flag == 0) continue;
      }
      codeCell<I>(coder, models, field, x, y, steps.level[I]);
    }
  }
}

/// Encodes or decodes all numbers of a slice.
template <class Coder>
void codeHeights(Coder& coder, SymbolModels& models, Field& field, const Steps& steps) {
  codeBase(coder, models, field, steps);
  codeLevel<0>(coder, models, field, steps);
  codeLevel<1>(coder, models, field, steps);
  codeLevel<2>(coder, models, field, steps);
}

}  // namespace hapticast::codec
