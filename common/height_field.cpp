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

/// The 4 x 4 pixels around a point: column and row indices (held at the border) and the fractions
/// from the second to the third pixel.
struct Cell {
  std::array<std::size_t, 4> column{};
  std::array<std::size_t, 4> row{};  // already multiplied by the width
  double a = 0.0;
  double b = 0.0;
};

/// Index and fraction along one axis, samples at pixel centres.
double locate(double coordinate_px, int first_px, int count, std::array<std::size_t, 4>& index) {
  const double x = std::clamp(coordinate_px - first_px - 0.5, 0.0, static_cast<double>(count - 1));
  const int i = std::min(static_cast<int>(x), count - 2);
  for (int k = 0; k < 4; ++k) {
    index[static_cast<std::size_t>(k)] =
        static_cast<std::size_t>(std::clamp(i + k - 1, 0, count - 1));
  }
  return x - i;
}

Cell cellAt(const PixelRect& rect, const Vec2& image_px) {
  Cell cell;
  cell.a = locate(image_px.x(), rect.u, rect.width, cell.column);
  cell.b = locate(image_px.y(), rect.v, rect.height, cell.row);
  for (std::size_t& row : cell.row) row *= static_cast<std::size_t>(rect.width);
  return cell;
}

using Weights = std::array<double, 4>;

/// Weights of value and derivative (per px) along one axis, and those the derivative of the *other*
/// axis is smoothed with.
struct AxisWeights {
  Weights value;
  Weights derivative;
  Weights across;
};

/// Linear value; Sobel's [-1 0 1]/2 and [1 2 1]/4 interpolated linearly: together the bilinear mean
/// of the four pixels' Sobel gradients (Eq. 11-12), each pixel weighted by the area opposite to it.
AxisWeights bilinearWeights(double t) {
  const double s = 1.0 - t;
  return {{0.0, s, t, 0.0},
          {-0.5 * s, -0.5 * t, 0.5 * s, 0.5 * t},
          {0.25 * s, 0.5 * s + 0.25 * t, 0.25 * s + 0.5 * t, 0.25 * t}};
}

SurfaceSample combine(const std::vector<float>& values, const Cell& cell, const AxisWeights& x,
                      const AxisWeights& y, const Vec2& px_per_mm) {
  double value = 0.0;
  double per_u = 0.0;
  double per_v = 0.0;
  for (std::size_t j = 0; j < 4; ++j) {
    double row_value = 0.0;
    double row_derivative = 0.0;
    double row_across = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto sample = static_cast<double>(values[cell.row[j] + cell.column[i]]);
      row_value += x.value[i] * sample;
      row_derivative += x.derivative[i] * sample;
      row_across += x.across[i] * sample;
    }
    value += y.value[j] * row_value;
    per_u += y.across[j] * row_derivative;
    per_v += y.derivative[j] * row_across;
  }
  // v runs against y.
  return {value, {per_u * px_per_mm.x(), -per_v * px_per_mm.y()}};
}

// --- the cubic B-spline, four floats at a time
// -----------------------------------------------------

using Four [[gnu::vector_size(16)]] = float;

Four load(const float* from) {
  Four values;
  std::memcpy(&values, from, sizeof(values));
  return values;
}

/// Weights of the four pixels along one axis: value, first and second derivative per px.
struct SplineWeights {
  Four value, slope, bend;
};

SplineWeights splineWeights(float t) {
  // The four polynomials in t: ((cube t + square) t + line) t + constant, all over 6.
  constexpr Four kCube = {-1.0F / 6, 3.0F / 6, -3.0F / 6, 1.0F / 6};
  constexpr Four kSquare = {3.0F / 6, -6.0F / 6, 3.0F / 6, 0.0F};
  constexpr Four kLine = {-3.0F / 6, 0.0F, 3.0F / 6, 0.0F};
  constexpr Four kConstant = {1.0F / 6, 4.0F / 6, 1.0F / 6, 0.0F};
  return {((kCube * t + kSquare) * t + kLine) * t + kConstant,
          (3.0F * kCube * t + 2.0F * kSquare) * t + kLine, 6.0F * kCube * t + 2.0F * kSquare};
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

/// The 4 x 4 pixels at a point, summed along v: with the weights of value, slope and bend.
struct Columns {
  SplineWeights u;
  SplineWeights v;
  std::array<Four, 4> row;

  [[nodiscard]] Four along(const Four& weights) const {
    return weights[0] * row[0] + weights[1] * row[1] + weights[2] * row[2] + weights[3] * row[3];
  }
};

Columns columnsAt(const std::vector<float>& values, const PixelRect& rect, const Vec2& image_px) {
  const Taps u = tapsAt(image_px.x(), rect.u, rect.width);
  const Taps v = tapsAt(image_px.y(), rect.v, rect.height);
  const auto stride = static_cast<std::size_t>(rect.width);
  const float* const from = values.data() + v.first * stride + u.first;
  return {splineWeights(u.t),
          splineWeights(v.t),
          {load(from), load(from + stride), load(from + 2 * stride), load(from + 3 * stride)}};
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
  const Cell cell = cellAt(prepared_, image_px);
  return combine(height_mm_, cell, bilinearWeights(cell.a), bilinearWeights(cell.b), px_per_mm_);
}

CurvedSample HeightField::spline(const Vec2& image_px) const noexcept {
  const Columns at = columnsAt(height_mm_, prepared_, image_px);
  const Four value = at.along(at.v.value);
  const Four slope = at.along(at.v.slope);
  const Four first =
      sums(at.u.value * value, at.u.slope * value, at.u.value * slope, at.u.slope * slope);
  const Four bend = at.along(at.v.bend);
  const Four second = sums(at.u.bend * value, at.u.value * bend, Four{}, Four{});
  // v runs against y.
  CurvedSample sample;
  const Vec2& per_mm = px_per_mm_;
  sample.height_mm = static_cast<double>(first[0]);
  sample.gradient = {static_cast<double>(first[1]) * per_mm.x(),
                     -static_cast<double>(first[2]) * per_mm.y()};
  sample.bend_xx = static_cast<double>(second[0]) * per_mm.x() * per_mm.x();
  sample.bend_xy = -static_cast<double>(first[3]) * per_mm.x() * per_mm.y();
  sample.bend_yy = static_cast<double>(second[1]) * per_mm.y() * per_mm.y();
  return sample;
}

EdgeSample HeightField::edge(const Vec2& image_px) const noexcept {
  const Columns at = columnsAt(edge_mm_, prepared_, image_px);
  const Four value = at.along(at.v.value);
  const Four first =
      sums(at.u.value * value, at.u.slope * value, at.u.value * at.along(at.v.slope), Four{});
  return {static_cast<double>(first[0]),
          {static_cast<double>(first[1]) * px_per_mm_.x(),
           -static_cast<double>(first[2]) * px_per_mm_.y()}};
}

}  // namespace hapticast
