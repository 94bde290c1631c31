// SPDX-License-Identifier: MIT
// The order and the models of a slice's numbers, written once for both directions
// (range_coder.hpp): base nodes, then the details of the levels. Thread: any.
#pragma once

#include <array>
#include <cstdlib>

#include "common/wire/slice/field.hpp"
#include "common/wire/slice/range_coder.hpp"

namespace hapticast::codec {

/// Which of five models a point has, by the sum of the sizes around it.
inline constexpr auto kDetailClass = [] {
  std::array<std::uint8_t, 6 * kMostSize + 1> out{};
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint8_t>(i < 3 ? i : i < 7 ? 3 : 4);
  return out;
}();

struct SymbolModels {
  std::array<NumberModel, 4> base;
  using Rows = std::array<std::array<NumberModel, 5>, 2>;
  std::array<Rows, 3> detail;  ///< by level, odd or even row, class
  std::array<std::array<std::array<BitModel, 3>, 2>, 3> flag;
};

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
      const std::int32_t rest = codeNumber(coder, model, value[at] - guess, true);
      residual[at] = std::min(std::abs(rest), kMostResidual);
      if constexpr (Coder::kDecodes) value[at] = std::clamp(guess + rest, -most, most);
    }
  }
}

/// The points of a cell, N in a row; those of even rows and columns are the coarser level's.
template <int N, class Coder>
void codeCell(Coder& coder, SymbolModels::Rows& models, Field& field, Level& level, int cell_x,
              int cell_y, int step) {
  constexpr int kPx = kCell_px / N;
  const std::uint8_t* mask =
      field.mask.data + cell_y * kCell_px * field.mask.stride + cell_x * kCell_px;
  const std::ptrdiff_t stride = level.stride;
  const std::int32_t farthest = (1 << 25) / step;
  for (int y = 0; y < N; ++y) {
    auto& row_models = models[static_cast<std::size_t>(y & 1)];
    const std::ptrdiff_t row = level.at(cell_x * N, cell_y * N + y);
    for (int x = (y & 1) ^ 1; x < N; x += 2 - (y & 1)) {
      if (mask[y * kPx * field.mask.stride + x * kPx] == 0) continue;
      std::uint8_t* size = level.size.data() + row + x;
      const int around = size[-1] + size[-2] + size[-stride] + size[-2 * stride] +
                         size[-stride - 1] + size[-stride + 1];
      NumberModel& model = row_models[kDetailClass[static_cast<std::size_t>(around)]];
      const std::int32_t wanted =
          Coder::kDecodes ? 0 : level.detail[static_cast<std::size_t>(row + x)];
      const std::int32_t value = codeNumber(coder, model, wanted, false);
      if (value == 0) continue;
      *size = static_cast<std::uint8_t>(std::min(std::abs(value), kMostSize));
      if constexpr (Coder::kDecodes) {
        const int point_y = cell_y * N + y;
        auto& patches = (y & 1) == 0 ? level.even : level.odd;
        patches.push_back({static_cast<std::uint32_t>(point_y * level.columns + cell_x * N + x),
                           std::clamp(value, -farthest, farthest) * step});
      }
    }
  }
}

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
      codeCell<(2 << I)>(coder, models.detail[I], field, level, x, y, steps.level[I]);
    }
  }
}

template <class Coder>
void codeHeights(Coder& coder, SymbolModels& models, Field& field, const Steps& steps) {
  codeBase(coder, models, field, steps);
  codeLevel<0>(coder, models, field, steps);
  codeLevel<1>(coder, models, field, steps);
  codeLevel<2>(coder, models, field, steps);
}

}  // namespace hapticast::codec
