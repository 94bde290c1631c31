// SPDX-License-Identifier: MIT
#include "common/codec/slice/rough.hpp"

#include <algorithm>

namespace hapticast::codec {

namespace {

/// Calls `call`(height, x, y) for each pixel inside.
template <class Call>
void forEachPixel(const Shape& shape, const Surroundings& object, const Call& call) {
  for (int y = 0; y < shape.height; ++y) {
    const std::ptrdiff_t row = y * object.mask.stride;
    for (int x = 0; x < shape.width; ++x) {
      if (object.mask.data[row + x] != 0) call(object.target[row + x], x, y);
    }
  }
}

/// Returns few levels such that every height is within `farthest` of its level, with repeated
/// distances where possible. `table`: on entry 1 for occurring heights, from `lowest` on; on return
/// the index of each height's level.
Levels buildLevels(std::vector<std::int32_t>& table, std::int32_t lowest, std::int32_t farthest) {
  Levels out;
  std::int32_t gap = 2 * farthest + 1;
  const auto size = static_cast<std::int32_t>(table.size());
  for (std::int32_t next = 0; next < size;) {
    if (table[static_cast<std::size_t>(next)] == 0) {
      ++next;
      continue;
    }
    // The heights that one level can represent; the previous distance if it suffices.
    std::int32_t last = std::min(size - 1, next + 2 * farthest);
    while (table[static_cast<std::size_t>(last)] == 0) --last;
    std::int32_t level = lowest + next + (last - next) / 2;
    if (!out.empty()) {
      const std::int32_t usual = out.back() + gap;
      if (std::abs(usual - lowest - next) <= farthest) level = usual;
      gap = level - out.back();
    }
    for (; next < size && next <= level + farthest - lowest; ++next)
      table[static_cast<std::size_t>(next)] = static_cast<std::int32_t>(out.size());
    out.push_back(level);
  }
  return out;
}

}  // namespace

Levels findLevels(const Shape& shape, const Surroundings& object, std::int32_t farthest,
                  Numbers& numbers) {
  std::int32_t lowest = kHighest;
  std::int32_t highest = -kHighest;
  forEachPixel(shape, object, [&](std::int32_t height, int, int) {
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  });
  // First the occurring heights, then the index of each height's level.
  std::vector<std::int32_t> table(static_cast<std::size_t>(highest - lowest) + 1, 0);
  forEachPixel(shape, object, [&](std::int32_t height, int, int) {
    table[static_cast<std::size_t>(height - lowest)] = 1;
  });
  Levels levels = buildLevels(table, lowest, farthest);
  forEachPixel(shape, object, [&](std::int32_t height, int x, int y) {
    numbers.level[static_cast<std::size_t>(numbers.at(x, y))] =
        table[static_cast<std::size_t>(height - lowest)];
  });
  return levels;
}

}  // namespace hapticast::codec
