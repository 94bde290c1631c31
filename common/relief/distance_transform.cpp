// SPDX-License-Identifier: MIT
#include "common/relief/distance_transform.hpp"

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>

namespace hapticast {

namespace {

// Row offset larger than any picture: no marked pixel.
constexpr std::int32_t kNone = 1 << 24;

/// Returns for each pixel the row of the nearest marked pixel in its column, +-kNone if there is
/// none. Without branches, so that the compiler vectorises over columns.
std::vector<std::int32_t> nearestInColumn(const std::vector<std::uint8_t>& mask, int width,
                                          int height, std::uint8_t marked) {
  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::int32_t> row(mask.size());
  std::vector<std::int32_t> last(columns, -kNone);
  for (std::int32_t v = 0; v < height; ++v) {
    const std::size_t start = static_cast<std::size_t>(v) * columns;
    const std::uint8_t* const is = mask.data() + start;
    std::int32_t* const at = row.data() + start;
    for (std::size_t u = 0; u < columns; ++u) at[u] = last[u] = is[u] == marked ? v : last[u];
  }
  last.assign(columns, kNone);
  for (std::int32_t v = height - 1; v >= 0; --v) {
    std::int32_t* const at = row.data() + static_cast<std::size_t>(v) * columns;
    for (std::size_t u = 0; u < columns; ++u) {
      last[u] = at[u] == v ? v : last[u];
      at[u] = last[u] - v < v - at[u] ? last[u] : at[u];
    }
  }
  return row;
}

/// Lower envelope of parabolas along one row. Candidates are the columns' nearest pixels; parabola
/// i is height[i] + (step * (u - i))².
class LowerEnvelope {
 public:
  LowerEnvelope(std::size_t width, double step)
      : squared_step_(step * step), column_(width), from_(width), height_(width), half_per_(width) {
    for (std::size_t gap = 1; gap < width; ++gap) {
      half_per_[gap] = 0.5 / (squared_step_ * static_cast<double>(gap));
    }
  }

  void clear() { count_ = 0; }
  void add(int column, double height) {
    double from = -std::numeric_limits<double>::infinity();
    while (count_ > 0) {
      const std::size_t top = count_ - 1;
      const auto gap = static_cast<std::size_t>(column - column_[top]);
      from = 0.5 * (column + column_[top]) + (height - height_[top]) * half_per_[gap];
      if (from > from_[top]) break;
      --count_;
    }
    if (count_ == 0) from = -std::numeric_limits<double>::infinity();
    column_[count_] = column;
    from_[count_] = from;
    height_[count_] = height;
    ++count_;
  }
  /// Calls `visit`(u, column of the nearest, squared distance) for u = 0..width-1. Requires a
  /// candidate.
  template <class Visit>
  void forEach(int width, Visit visit) const {
    std::size_t k = 0;
    for (int u = 0; u < width; ++u) {
      while (k + 1 < count_ && from_[k + 1] <= u) ++k;
      const double du = u - column_[k];
      visit(u, column_[k], height_[k] + squared_step_ * du * du);
    }
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }

 private:
  double squared_step_;
  std::size_t count_ = 0;
  std::vector<int> column_;
  std::vector<double> from_;
  std::vector<double> height_;
  std::vector<double> half_per_;  // 1 / (2 step² gap)
};

/// Calls `visit`(index, squared distance, index of the nearest) for all pixels with a nearest
/// marked pixel; for a marked pixel that is itself.
template <class Visit>
void visitNearest(const std::vector<std::uint8_t>& mask, int width, int height, std::uint8_t marked,
                  const Vec2& mm_per_px, Visit visit) {
  const auto columns = static_cast<std::size_t>(width);
  const std::vector<std::int32_t> row = nearestInColumn(mask, width, height, marked);
  LowerEnvelope envelope(columns, mm_per_px.x());
  for (int v = 0; v < height; ++v) {
    const std::size_t start = static_cast<std::size_t>(v) * columns;
    envelope.clear();
    for (int u = 0; u < width; ++u) {
      const std::size_t i = start + static_cast<std::size_t>(u);
      const std::int32_t candidate = row[i];
      if (std::abs(candidate) == kNone) continue;
      // Within a run of marked pixels only its ends can be nearest to other pixels.
      const bool within_run =
          candidate == v && u > 0 && u + 1 < width && row[i - 1] == v && row[i + 1] == v;
      if (within_run) continue;
      const double dv_mm = mm_per_px.y() * (v - candidate);
      envelope.add(u, dv_mm * dv_mm);
    }
    if (envelope.empty()) continue;
    envelope.forEach(width, [&](int u, int column, double squared) {
      const std::size_t i = start + static_cast<std::size_t>(u);
      if (row[i] == v) {
        visit(i, 0.0, static_cast<std::int32_t>(i));
      } else {
        visit(i, squared, row[start + static_cast<std::size_t>(column)] * width + column);
      }
    });
  }
}

}  // namespace

NearestPixel nearestPixel(const std::vector<std::uint8_t>& mask, int width, int height,
                          std::uint8_t marked, const Vec2& mm_per_px) {
  NearestPixel result;
  result.distance_mm.assign(mask.size(), std::numeric_limits<float>::infinity());
  result.nearest.assign(mask.size(), -1);
  visitNearest(mask, width, height, marked, mm_per_px,
               [&](std::size_t i, double squared, std::int32_t nearest) {
                 result.distance_mm[i] = static_cast<float>(std::sqrt(squared));
                 result.nearest[i] = nearest;
               });
  return result;
}

std::vector<float> distanceTo(const std::vector<std::uint8_t>& mask, int width, int height,
                              std::uint8_t marked, const Vec2& mm_per_px) {
  std::vector<float> distance_mm(mask.size(), std::numeric_limits<float>::infinity());
  visitNearest(mask, width, height, marked, mm_per_px,
               [&](std::size_t i, double squared, std::int32_t) {
                 distance_mm[i] = static_cast<float>(std::sqrt(squared));
               });
  return distance_mm;
}

}  // namespace hapticast
