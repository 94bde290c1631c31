// SPDX-License-Identifier: MIT
#include "common/deepest_point.hpp"

#include <algorithm>
#include <cstddef>

namespace hapticast {

namespace {
// Chamfer steps 3 : 4 for straight : diagonal neighbours.
constexpr int kStraight = 3;
constexpr int kDiagonal = 4;
}  // namespace

Vec2 deepestPoint(const PixelRect& rect, const std::vector<std::uint8_t>& mask) {
  if (rect.empty()) return Vec2::Zero();
  const auto width = static_cast<std::size_t>(rect.width);
  const auto height = static_cast<std::size_t>(rect.height);
  if (mask.size() != width * height) return Vec2::Zero();
  const std::size_t stride = width + 2;  // a border of zeros all around
  std::vector<int> distance(stride * (height + 2), 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0) continue;
    int* const d = &distance[(i / width + 1) * stride + i % width + 1];
    *d = std::min(std::min(d[-1], *(d - stride)) + kStraight,
                  std::min(*(d - stride - 1), *(d - stride + 1)) + kDiagonal);
  }
  std::size_t deepest = mask.size();
  int most = 0;
  for (std::size_t i = mask.size(); i-- > 0;) {
    if (mask[i] == 0) continue;
    int* const d = &distance[(i / width + 1) * stride + i % width + 1];
    *d = std::min({*d, std::min(d[1], d[stride]) + kStraight,
                   std::min(d[stride + 1], d[stride - 1]) + kDiagonal});
    if (*d >= most) {
      most = *d;
      deepest = i;
    }
  }
  if (deepest == mask.size()) return Vec2::Zero();
  const std::size_t column = deepest % width;
  const std::size_t row = deepest / width;
  return {rect.u + static_cast<double>(column) + 0.5, rect.v + static_cast<double>(row) + 0.5};
}

}  // namespace hapticast
