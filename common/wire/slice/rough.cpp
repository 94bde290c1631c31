// SPDX-License-Identifier: MIT
#include "common/wire/slice/rough.hpp"

#include <algorithm>

namespace hapticast::codec {

namespace {

std::vector<std::int32_t> heightsOf(const Shape& shape, const Mask& mask,
                                    const std::int32_t* target) {
  std::vector<std::int32_t> out;
  out.reserve(static_cast<std::size_t>(shape.width) * static_cast<std::size_t>(shape.height));
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const std::ptrdiff_t at = y * mask.stride + x;
      if (mask.data[at] != 0) out.push_back(target[at]);
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

Levels levelsOf(const Shape& shape, const Mask& mask, const std::int32_t* target,
                std::int32_t farthest) {
  const std::vector<std::int32_t> heights = heightsOf(shape, mask, target);
  Levels out;
  std::int32_t gap = 2 * farthest + 1;
  for (auto next = heights.begin(); next != heights.end();) {
    // The heights that one level can stand for; the distance of before if that will do.
    const auto end = std::upper_bound(next, heights.end(), *next + 2 * farthest);
    std::int32_t level = *next + (*(end - 1) - *next) / 2;
    if (!out.empty()) {
      const std::int32_t usual = out.back() + gap;
      if (std::abs(usual - *next) <= farthest) level = usual;
      gap = level - out.back();
    }
    out.push_back(level);
    next = std::upper_bound(next, heights.end(), level + farthest);
  }
  return out;
}

std::int32_t nearestLevel(const Levels& levels, std::int32_t height) {
  const auto above = std::lower_bound(levels.begin(), levels.end(), height);
  const auto number = static_cast<std::int32_t>(above - levels.begin());
  if (above == levels.end()) return number - 1;
  return number > 0 && height - *(above - 1) < *above - height ? number - 1 : number;
}

}  // namespace hapticast::codec
