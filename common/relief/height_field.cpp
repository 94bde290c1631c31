// SPDX-License-Identifier: MIT
// Sampling of a height field. Called in the 1 kHz loop: no heap, bounded time, any coordinate.
// Thread: any.
#include "common/relief/height_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "common/relief/distance_transform.hpp"
#include "common/relief/rim_fit.hpp"

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

namespace {

constexpr int kSeamPasses = 2;  // chosen

/// Smoothed signed distance to the mask's edge in mm, positive inside.
std::vector<float> edgeDistance(const std::vector<std::uint8_t>& mask, int width, int height,
                                const std::vector<float>& to_inside_mm,
                                std::vector<float> to_outside_mm, const Vec2& mm_per_px) {
  // The edge runs between pixel centres.
  const auto half = static_cast<float>(0.5 * mm_per_px.mean());
  const auto limit = static_cast<float>(HeightField::kMargin_px * mm_per_px.mean());
  std::vector<float> edge = std::move(to_outside_mm);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const float signed_mm = mask[i] != 0 ? edge[i] - half : half - to_inside_mm[i];
    edge[i] = std::clamp(signed_mm, -limit, limit);
  }
  smoothEdgeDistance(edge, width, height, mm_per_px);
  return edge;
}

/// Smooths the seams between the fits of two rim pixels. Averaging of neighbours does not change
/// planes. Uses only pixels whose neighbours are all within the fits' reach.
void smoothSeams(std::vector<float>& height_mm, const std::vector<std::uint8_t>& mask, int width,
                 int height, const NearestPixel& to_inside, double mm_per_px) {
  const auto columns = static_cast<std::size_t>(width);
  const auto limit = static_cast<float>((HeightField::kMargin_px - 1) * mm_per_px);
  std::vector<std::size_t> seam;
  for (std::size_t v = 1; v + 1 < static_cast<std::size_t>(height); ++v) {
    for (std::size_t i = v * columns + 1; i + 1 < (v + 1) * columns; ++i) {
      if (mask[i] == 0 && to_inside.distance_mm[i] <= limit) seam.push_back(i);
    }
  }
  std::vector<float> smooth(seam.size());
  for (int pass = 0; pass < kSeamPasses; ++pass) {
    const float* const from = height_mm.data();
    for (std::size_t k = 0; k < seam.size(); ++k) {
      const float* const at = from + seam[k];
      smooth[k] = 0.5F * *at + 0.125F * (*(at - 1) + *(at + 1) + *(at - columns) + *(at + columns));
    }
    for (std::size_t k = 0; k < seam.size(); ++k) height_mm[seam[k]] = smooth[k];
  }
}

/// Returns the largest value. Requires values without NaN, at least one. Vectorised: eight maxima
/// in parallel.
float largest(const std::vector<float>& values) {
  constexpr std::size_t kSideBySide = 8;
  std::array<float, kSideBySide> most;
  most.fill(values.front());
  std::size_t i = 0;
  for (; i + kSideBySide <= values.size(); i += kSideBySide) {
    for (std::size_t k = 0; k < kSideBySide; ++k) most[k] = std::max(most[k], values[i + k]);
  }
  for (; i < values.size(); ++i) most[0] = std::max(most[0], values[i]);
  return *std::max_element(most.begin(), most.end());
}

/// Fills the pixels outside the mask from the fit of their nearest mask pixel.
void continueHeights(std::vector<float>& height_mm, const std::vector<std::uint8_t>& mask,
                     int width, int height, const NearestPixel& to_inside, const Vec2& mm_per_px) {
  std::unordered_map<std::int32_t, RimFit> fits;  // by rim pixel
  const auto farthest = static_cast<float>((HeightField::kMargin_px + 2) * mm_per_px.maxCoeff());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const std::int32_t rim = to_inside.nearest[i];
    if (mask[i] != 0 || rim < 0) continue;
    if (to_inside.distance_mm[i] > farthest) {  // beyond the reach of contact
      height_mm[i] = height_mm[static_cast<std::size_t>(rim)];
      continue;
    }
    const int u = rim % width;
    const int v = rim / width;
    auto fit = fits.find(rim);
    if (fit == fits.end()) fit = fits.try_emplace(rim, height_mm, mask, width, height, u, v).first;
    const auto here = static_cast<int>(i);
    const int row = here / width;
    height_mm[i] = static_cast<float>(fit->second.at(here % width - u, row - v));
  }
  smoothSeams(height_mm, mask, width, height, to_inside, mm_per_px.minCoeff());
}

}  // namespace

HeightField HeightField::makePadded(const Relief& relief, const Workspace& workspace) {
  HeightField field;
  field.rect_ = relief.rect;
  field.mm_per_px_ = workspace.mmPerPixel();
  field.px_per_mm_ = field.mm_per_px_.cwiseInverse();
  const PixelRect& rect = field.rect_;
  const auto columns = static_cast<std::size_t>(std::max(rect.width, 0));
  const auto rows = static_cast<std::size_t>(std::max(rect.height, 0));
  if (rect.empty() || relief.height_mm.size() != columns * rows ||
      relief.mask.size() != columns * rows) {
    return field;
  }
  field.prepared_ = {rect.u - kMargin_px, rect.v - kMargin_px, rect.width + 2 * kMargin_px,
                     rect.height + 2 * kMargin_px};
  field.first_px_ = Vec2(field.prepared_.u, field.prepared_.v) + Vec2::Constant(0.5);
  field.size_px_ = Vec2(field.prepared_.width, field.prepared_.height);
  constexpr double kJustBefore_px = 1e-9;  // excludes the point exactly on the next pixel
  field.last_cell_ = field.size_px_ - Vec2::Constant(2.0 + kJustBefore_px);
  const auto width = static_cast<std::size_t>(field.prepared_.width);
  const auto height = static_cast<std::size_t>(field.prepared_.height);
  field.height_mm_.assign(width * height, 0.0F);
  field.mask_.assign(width * height, 0);
  for (std::size_t v = 0; v < rows; ++v) {
    for (std::size_t u = 0; u < columns; ++u) {
      if (relief.mask[v * columns + u] == 0) continue;
      const std::size_t to = (v + kMargin_px) * width + u + kMargin_px;
      field.mask_[to] = 1;
      field.height_mm_[to] = relief.height_mm[v * columns + u];
    }
  }
  return field;
}

void HeightField::complete(bool continued) {
  if (empty()) return;
  const int width = prepared_.width;
  const int height = prepared_.height;
  const NearestPixel to_inside = findNearestPixel(mask_, width, height, 1, mm_per_px_);
  std::vector<float> to_outside_mm = distanceTo(mask_, width, height, 0, mm_per_px_);
  const auto deepest = static_cast<int>(
      std::distance(to_outside_mm.begin(),
                    std::find(to_outside_mm.begin(), to_outside_mm.end(), largest(to_outside_mm))));
  deepest_height_mm_ = static_cast<double>(height_mm_[static_cast<std::size_t>(deepest)]);
  const int row = deepest / width;
  deepest_px_ = {prepared_.u + deepest % width + 0.5, prepared_.v + row + 0.5};
  edge_mm_ = edgeDistance(mask_, width, height, to_inside.distance_mm, std::move(to_outside_mm),
                          mm_per_px_);
  if (continued) continueHeights(height_mm_, mask_, width, height, to_inside, mm_per_px_);
  highest_mm_ = static_cast<double>(largest(height_mm_));
}

HeightField HeightField::prepare(const Relief& relief, const Workspace& workspace) {
  HeightField field = makePadded(relief, workspace);
  field.complete(true);
  return field;
}

HeightField HeightField::prepareThesis(const Relief& relief, const Workspace& workspace) {
  HeightField field = makePadded(relief, workspace);
  field.complete(false);
  return field;
}

}  // namespace hapticast
