// SPDX-License-Identifier: MIT
// Sampling of a height field. Called in the 1 kHz loop: no heap, bounded time, any coordinate.
// Thread: any.
#include "common/relief/height_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace hapticast {

namespace {

using Four [[gnu::vector_size(16)]] = float;

Four load(const float* from) {
  Four values;
  std::memcpy(&values, from, sizeof(values));
  return values;
}

/// Weights of four pixels along one axis, for a position t beyond the second: of the value and its
/// derivatives per px.
struct SplineWeights {
  Four value, slope, bend;
};

SplineWeights splineWeights(float t) {
  // The four polynomials in t: ((cube t + square) t + line) t + constant, all over 6.
  constexpr Four kCube = {-1.0F / 6, 3.0F / 6, -3.0F / 6, 1.0F / 6};
  constexpr Four kSquare = {3.0F / 6, -6.0F / 6, 3.0F / 6, 0.0F};
  constexpr Four kLine = {-3.0F / 6, 0.0F, 3.0F / 6, 0.0F};
  constexpr Four kConstant = {1.0F / 6, 4.0F / 6, 1.0F / 6, 0.0F};
  const Four value = ((kCube * t + kSquare) * t + kLine) * t + kConstant;
  return {value, (3.0F * kCube * t + 2.0F * kSquare) * t + kLine,
          6.0F * kCube * t + 2.0F * kSquare};
}

/// Returns the sums of a, b, c and d, each over its four values.
Four sums(const Four& a, const Four& b, const Four& c, const Four& d) {
  const Four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5) +  //
                  __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Four cd = __builtin_shufflevector(c, d, 0, 4, 1, 5) +  //
                  __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// The 4 x 4 pixels around a point, row by row, and the point's position between them.
struct Cell {
  float u, v;
  std::array<Four, 4> row;

  /// Returns for each column the weighted sum over the rows.
  [[nodiscard]] Four down(const Four& weights) const {
    return weights[0] * row[0] + weights[1] * row[1] + weights[2] * row[2] + weights[3] * row[3];
  }
};

/// Returns the pixels around a point, which is measured from the first pixel's centre. The point is
/// clamped to 1 .. `last`, less than two below the last centre, so that all pixels exist. Without
/// branches; a NaN counts as 1.
[[gnu::always_inline]] inline Cell interpolateCell(const std::vector<float>& values,
                                                   std::ptrdiff_t stride, const Vec2& from_first_px,
                                                   const Vec2& last) {
  const double x = std::min(std::max(1.0, from_first_px.x()), last.x());
  const double y = std::min(std::max(1.0, from_first_px.y()), last.y());
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  const float* const row = values.data() + (j - 1) * stride + (i - 1);
  return {static_cast<float>(x - i),
          static_cast<float>(y - j),
          {load(row), load(row + stride), load(row + 2 * stride), load(row + 3 * stride)}};
}

/// Converts derivatives per px to nominal mm; v runs against y.
Vec2 computeGradient(const Four& sample, const Vec2& px_per_mm) {
  return Vec2(static_cast<double>(sample[1]), -static_cast<double>(sample[2]))
      .cwiseProduct(px_per_mm);
}

}  // namespace

bool HeightField::inside(const Vec2& image_px) const noexcept {
  if (empty()) return false;
  const Vec2 from_edge_px = image_px - first_px_ + Vec2::Constant(0.5);
  const double u = from_edge_px.x();
  const double v = from_edge_px.y();
  // A NaN fails this test.
  if (!(u >= 0.0 && u < size_px_.x() && v >= 0.0 && v < size_px_.y())) return false;
  return mask_[static_cast<std::size_t>(static_cast<int>(v) * prepared_.width +
                                        static_cast<int>(u))] != 0;
}

SurfaceSample HeightField::bilinear(const Vec2& image_px) const noexcept {
  const Cell cell = interpolateCell(height_mm_, prepared_.width, image_px - first_px_, last_cell_);
  // Interpolates the value between two pixels of a column. Sobel's [1 2 1] and [-1 0 1] of one
  // pixel blend into those of the other. So each of the four pixels' Sobel gradients has the weight
  // of the opposite area.
  const auto& [top, upper, lower, bottom] = cell.row;
  const Four between = lower - upper;
  const Four above = top + upper, below = lower + bottom, middle = upper + lower;
  const Four value = upper + cell.v * between;
  const Four across = above + middle + cell.v * (below - above);
  const Four slope = lower - top + cell.v * (bottom - upper - (lower - top));
  const float t = cell.u;
  const float s = 1.0F - t;
  const Four linear = {0.0F, s, t, 0.0F};
  const Four step = {-s, -t, s, t};
  const Four smooth = {s, 1.0F + s, 1.0F + t, t};
  const Four sample = sums(linear * value, 0.125F * step * across, 0.125F * smooth * slope, Four{});
  return {static_cast<double>(sample[0]), computeGradient(sample, px_per_mm_)};
}

CurvedSample HeightField::spline(const Vec2& image_px) const noexcept {
  const Cell cell = interpolateCell(height_mm_, prepared_.width, image_px - first_px_, last_cell_);
  const SplineWeights u = splineWeights(cell.u);
  const SplineWeights v = splineWeights(cell.v);
  const Four value = cell.down(v.value);
  const Four slope = cell.down(v.slope);
  const Four first = sums(u.value * value, u.slope * value, u.value * slope, u.slope * slope);
  const Four second = sums(u.bend * value, u.value * cell.down(v.bend), Four{}, Four{});
  const Vec2& per_mm = px_per_mm_;
  CurvedSample sample;
  sample.height_mm = static_cast<double>(first[0]);
  sample.gradient = computeGradient(first, per_mm);
  sample.bend_xx = static_cast<double>(second[0]) * per_mm.x() * per_mm.x();
  sample.bend_xy = -static_cast<double>(first[3]) * per_mm.x() * per_mm.y();
  sample.bend_yy = static_cast<double>(second[1]) * per_mm.y() * per_mm.y();
  return sample;
}

EdgeSample HeightField::edge(const Vec2& image_px) const noexcept {
  const Cell cell = interpolateCell(edge_mm_, prepared_.width, image_px - first_px_, last_cell_);
  const SplineWeights u = splineWeights(cell.u);
  const SplineWeights v = splineWeights(cell.v);
  const Four value = cell.down(v.value);
  const Four sample = sums(u.value * value, u.slope * value, u.value * cell.down(v.slope), Four{});
  return {static_cast<double>(sample[0]), computeGradient(sample, px_per_mm_)};
}

}  // namespace hapticast
