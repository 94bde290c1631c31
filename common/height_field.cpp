// SPDX-License-Identifier: MIT
// Sampling: called in the 1 kHz loop. No heap, bounded, any coordinate.
#include "common/height_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

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

AxisWeights splineWeights(double t) {
  const double s = 1.0 - t;
  const Weights value{s * s * s / 6.0, (3.0 * t * t * (t - 2.0) + 4.0) / 6.0,
                      (3.0 * s * s * (s - 2.0) + 4.0) / 6.0, t * t * t / 6.0};
  return {value,
          {-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), -0.5 * s * (3.0 * s - 4.0), 0.5 * t * t},
          value};
}

SurfaceSample combine(const std::vector<float>& values, const Cell& cell, const AxisWeights& x,
                      const AxisWeights& y, const Vec2& mm_per_px) {
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
  return {value, {per_u / mm_per_px.x(), -per_v / mm_per_px.y()}};
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
  return combine(height_mm_, cell, bilinearWeights(cell.a), bilinearWeights(cell.b), mm_per_px_);
}

SurfaceSample HeightField::spline(const Vec2& image_px) const noexcept {
  if (empty() || !image_px.allFinite()) return {};
  const Cell cell = cellAt(prepared_, image_px);
  return combine(height_mm_, cell, splineWeights(cell.a), splineWeights(cell.b), mm_per_px_);
}

double HeightField::edgeDistance_mm(const Vec2& image_px) const noexcept {
  if (empty() || !image_px.allFinite()) return 0.0;
  const Cell cell = cellAt(prepared_, image_px);
  return combine(edge_mm_, cell, splineWeights(cell.a), splineWeights(cell.b), mm_per_px_)
      .height_mm;
}

}  // namespace hapticast
