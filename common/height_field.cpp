// SPDX-License-Identifier: MIT
// Sampling: called in the 1 kHz loop. No heap, bounded, any coordinate.
#include "common/height_field.hpp"

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

/// Weights of four pixels along one axis, t beyond the second: of the value, of the first
/// derivative per px, and those that the derivative of the *other* axis is smoothed with.
struct AxisWeights {
  Four value, slope, across;
};

/// Linear value; Sobel's [-1 0 1]/2 and [1 2 1]/4 interpolated linearly: together the bilinear mean
/// of the four pixels' Sobel gradients (Eq. 11-12), each pixel weighted by the area opposite to it.
AxisWeights bilinearWeights(float t) {
  const float s = 1.0F - t;
  return {Four{0.0F, s, t, 0.0F}, Four{-0.5F * s, -0.5F * t, 0.5F * s, 0.5F * t},
          Four{0.25F * s, 0.5F * s + 0.25F * t, 0.25F * s + 0.5F * t, 0.25F * t}};
}

struct SplineWeights : AxisWeights {
  Four bend;
};

SplineWeights splineWeights(float t) {
  // The four polynomials in t: ((cube t + square) t + line) t + constant, all over 6.
  constexpr Four kCube = {-1.0F / 6, 3.0F / 6, -3.0F / 6, 1.0F / 6};
  constexpr Four kSquare = {3.0F / 6, -6.0F / 6, 3.0F / 6, 0.0F};
  constexpr Four kLine = {-3.0F / 6, 0.0F, 3.0F / 6, 0.0F};
  constexpr Four kConstant = {1.0F / 6, 4.0F / 6, 1.0F / 6, 0.0F};
  const Four value = ((kCube * t + kSquare) * t + kLine) * t + kConstant;
  return {{value, (3.0F * kCube * t + 2.0F * kSquare) * t + kLine, value},
          6.0F * kCube * t + 2.0F * kSquare};
}

/// The sums of a, b, c and d, each over its four values.
Four sums(const Four& a, const Four& b, const Four& c, const Four& d) {
  const Four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5) +  //
                  __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Four cd = __builtin_shufflevector(c, d, 0, 4, 1, 5) +  //
                  __builtin_shufflevector(c, d, 2, 6, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/// Index of the first of the four pixels along one axis and the fraction from the second to the
/// third; all four lie within 0 .. count-1 (count >= 4). No branches; a NaN becomes the first.
struct Taps {
  std::size_t first;
  float t;
};
Taps tapsAt(double coordinate_px, int first_px, int count) {
  const double x = std::min(std::max(1.0, coordinate_px - first_px - 0.5), count - 2.0);
  const int i = std::min(static_cast<int>(x), count - 3);
  return {static_cast<std::size_t>(i - 1), static_cast<float>(x - i)};
}

/// The 4 x 4 pixels around a point, row by row, and where it lies between them.
struct Cell {
  float u, v;
  std::array<Four, 4> row;

  /// For each column the sum over the rows.
  [[nodiscard]] Four down(const Four& weights) const {
    return weights[0] * row[0] + weights[1] * row[1] + weights[2] * row[2] + weights[3] * row[3];
  }
};

[[gnu::always_inline]] inline Cell cellAt(const std::vector<float>& values, const PixelRect& rect,
                                          const Vec2& image_px) {
  const Taps u = tapsAt(image_px.x(), rect.u, rect.width);
  const Taps v = tapsAt(image_px.y(), rect.v, rect.height);
  const auto stride = static_cast<std::size_t>(rect.width);
  const float* const from = values.data() + v.first * stride + u.first;
  return {u.t,
          v.t,
          {load(from), load(from + stride), load(from + 2 * stride), load(from + 3 * stride)}};
}

/// Value, derivatives along u and v (per px), and nothing.
[[gnu::always_inline]] inline Four sampled(const Cell& cell, const AxisWeights& u,
                                           const AxisWeights& v) {
  return sums(u.value * cell.down(v.value), u.slope * cell.down(v.across),
              u.across * cell.down(v.slope), Four{});
}

/// From derivatives per px; v runs against y.
Vec2 gradientOf(const Four& sample, const Vec2& px_per_mm) {
  return Vec2(static_cast<double>(sample[1]), -static_cast<double>(sample[2]))
      .cwiseProduct(px_per_mm);
}

}  // namespace

bool HeightField::inside(const Vec2& image_px) const noexcept {
  if (empty()) return false;
  const double u = image_px.x() - prepared_.u;
  const double v = image_px.y() - prepared_.v;
  // Written so that a NaN fails.
  if (!(u >= 0.0 && u < prepared_.width && v >= 0.0 && v < prepared_.height)) return false;
  return mask_[static_cast<std::size_t>(v) * static_cast<std::size_t>(prepared_.width) +
               static_cast<std::size_t>(u)] != 0;
}

SurfaceSample HeightField::bilinear(const Vec2& image_px) const noexcept {
  if (empty() || !image_px.allFinite()) return {};
  const Cell cell = cellAt(height_mm_, prepared_, image_px);
  const Four sample = sampled(cell, bilinearWeights(cell.u), bilinearWeights(cell.v));
  return {static_cast<double>(sample[0]), gradientOf(sample, px_per_mm_)};
}

CurvedSample HeightField::spline(const Vec2& image_px) const noexcept {
  const Cell cell = cellAt(height_mm_, prepared_, image_px);
  const SplineWeights u = splineWeights(cell.u);
  const SplineWeights v = splineWeights(cell.v);
  const Four value = cell.down(v.value);
  const Four slope = cell.down(v.slope);
  const Four first = sums(u.value * value, u.slope * value, u.value * slope, u.slope * slope);
  const Four second = sums(u.bend * value, u.value * cell.down(v.bend), Four{}, Four{});
  const Vec2& per_mm = px_per_mm_;
  CurvedSample sample;
  sample.height_mm = static_cast<double>(first[0]);
  sample.gradient = gradientOf(first, per_mm);
  sample.bend_xx = static_cast<double>(second[0]) * per_mm.x() * per_mm.x();
  sample.bend_xy = -static_cast<double>(first[3]) * per_mm.x() * per_mm.y();
  sample.bend_yy = static_cast<double>(second[1]) * per_mm.y() * per_mm.y();
  return sample;
}

EdgeSample HeightField::edge(const Vec2& image_px) const noexcept {
  const Cell cell = cellAt(edge_mm_, prepared_, image_px);
  const Four sample = sampled(cell, splineWeights(cell.u), splineWeights(cell.v));
  return {static_cast<double>(sample[0]), gradientOf(sample, px_per_mm_)};
}

}  // namespace hapticast
