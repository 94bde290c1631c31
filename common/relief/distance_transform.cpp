// SPDX-License-Identifier: MIT
#include "common/relief/distance_transform.hpp"

#include <algorithm>
#include <array>
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
std::vector<std::int32_t> findNearestInColumn(const std::vector<std::uint8_t>& mask, int width,
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
  const std::vector<std::int32_t> row = findNearestInColumn(mask, width, height, marked);
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

NearestPixel findNearestPixel(const std::vector<std::uint8_t>& mask, int width, int height,
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

namespace {

constexpr double kSigma_px = 1.8;
constexpr std::size_t kRadius_px = 5;
// The fit has full weight up to kAll_px from the edge, decreasing to none at kNothing_px. A sample
// on the edge reads pixels up to 2.8 px away, with decreasing weight.
constexpr float kAll_px = 1.0F;
constexpr float kNothing_px = 4.0F;
// A mask determines its edge to half a pixel: about the largest deviation of distances from the
// quadratic.
constexpr float kSurelyGood_px = 0.25F;
constexpr float kSurelyBad_px = 0.75F;
constexpr int kLongestStep_px = 3;
// Loss of the Gaussian and the spline at a curved line of distances, for each unit of the second
// derivative: half their variances.
constexpr auto kBent_px2 = static_cast<float>(0.5 * (kSigma_px * kSigma_px + 1.0 / 3.0));

/// Writes a line of blurred values from the lines lineAt(-kRadius_px .. kRadius_px) around it.
template <class LineAt>
void blurLine(float* __restrict__ to, std::size_t length,
              const std::array<float, kRadius_px + 1>& weight, LineAt lineAt) {
  constexpr int kRadius = kRadius_px;
  std::array<const float*, 2 * kRadius_px + 1> from{};
  for (int k = -kRadius; k <= kRadius; ++k) from[static_cast<std::size_t>(k + kRadius)] = lineAt(k);
  for (std::size_t i = 0; i < length; ++i) {
    float sum = weight[0] * from[kRadius_px][i];
    for (std::size_t k = 1; k <= kRadius_px; ++k)
      sum += weight[k] * (from[kRadius_px - k][i] + from[kRadius_px + k][i]);
    to[i] = sum;
  }
}

/// Blurs by a separable Gaussian; the ends repeat the last value. Overwrites `scratch`, of equal
/// size.
void blur(std::vector<float>& values, std::vector<float>& scratch, int columns, int rows) {
  std::array<float, kRadius_px + 1> weight{};
  float sum = 0.0F;
  for (std::size_t k = 0; k <= kRadius_px; ++k) {
    const double x = static_cast<double>(k) / kSigma_px;
    weight[k] = static_cast<float>(std::exp(-0.5 * x * x));
    sum += (k == 0 ? 1.0F : 2.0F) * weight[k];
  }
  for (float& w : weight) w /= sum;
  const auto length = static_cast<std::size_t>(columns);
  std::vector<float> held(length + 2 * kRadius_px);
  for (std::size_t start = 0; start < values.size(); start += length) {
    const float* const row = values.data() + start;
    float* const middle = held.data() + kRadius_px;
    std::fill_n(held.data(), kRadius_px, row[0]);
    std::copy_n(row, length, middle);
    std::fill_n(middle + length, kRadius_px, row[length - 1]);
    blurLine(scratch.data() + start, length, weight, [=](int k) { return middle + k; });
  }
  for (int v = 0; v < rows; ++v) {
    blurLine(values.data() + static_cast<std::size_t>(v) * length, length, weight, [&](int k) {
      return scratch.data() + static_cast<std::size_t>(std::clamp(v + k, 0, rows - 1)) * length;
    });
  }
}

/// Values on a straight line: the middle one, then pairs of them to either side.
constexpr std::size_t kPairs = 8;
struct Line {
  float middle = 0.0F;
  std::array<float, kPairs> before{};
  std::array<float, kPairs> behind{};
};

/// Returns the weight of a value k steps from the middle in a fit.
constexpr float weight(float k) {
  constexpr float kBeyond = kPairs + 1;
  return 1.0F - k * k / (kBeyond * kBeyond);
}
/// Returns the sum of the weights times k to the power.
constexpr float moment(int power) {
  float sum = power == 0 ? weight(0) : 0.0F;
  for (std::size_t i = 1; i <= kPairs; ++i) {
    float term = 2.0F * weight(static_cast<float>(i));
    for (int p = 0; p < power; ++p) term *= static_cast<float>(i);
    sum += term;
  }
  return sum;
}

/// Weighted quadratic fit to a Line.
class LineFit {
 public:
  explicit LineFit(const Line& line) {
    float sum = weight(0) * line.middle;
    float square = 0.0F;
    float slope = 0.0F;
    for (std::size_t i = 0; i < kPairs; ++i) {
      const auto k = static_cast<float>(i + 1);
      const float pair = weight(k) * (line.behind[i] + line.before[i]);
      sum += pair;
      square += k * k * pair;
      slope += k * weight(k) * (line.behind[i] - line.before[i]);
    }
    constexpr float kPer = 1.0F / (moment(0) * moment(4) - moment(2) * moment(2));
    middle_ = kPer * (moment(4) * sum - moment(2) * square);
    bend_ = kPer * (moment(0) * square - moment(2) * sum);
    slope_ = slope / moment(2);
  }

  [[nodiscard]] float middle() const { return middle_; }
  /// Second derivative, per step between two values.
  [[nodiscard]] float bend() const { return 2.0F * bend_; }
  /// Returns the largest deviation of a value from the fit.
  [[nodiscard]] float off(const Line& line) const {
    std::array<float, kPairs> each;
    for (std::size_t i = 0; i < kPairs; ++i) {
      const auto k = static_cast<float>(i + 1);
      const float even = middle_ + bend_ * k * k;
      each[i] = std::max(std::abs(line.behind[i] - even - slope_ * k),
                         std::abs(line.before[i] - even + slope_ * k));
    }
    return std::max(std::abs(line.middle - middle_), *std::max_element(each.begin(), each.end()));
  }

 private:
  float middle_ = 0.0F;
  float slope_ = 0.0F;
  float bend_ = 0.0F;
};

/// The line through a pixel along the nearby edge: one pixel along the axis closer to it, `lean`
/// along the other, for each step.
class AlongEdge {
 public:
  AlongEdge(const std::vector<float>& values, int width, int height, int u, int v)
      : pixel_(values.data() + std::ptrdiff_t{v} * width + u) {
    const float du = pixel_[1] - pixel_[-1];
    const float dv = pixel_[width] - pixel_[-width];
    const bool level = std::abs(dv) > std::abs(du);
    along_ = level ? 1 : width;
    across_ = level ? width : 1;
    const float lean = level ? -du / dv : (du == 0.0F ? 0.0F : -dv / du);
    if (lean < 0.0F) across_ = -across_;
    lean_ = std::abs(lean);
    const int room_u = std::min(u, width - 1 - u);
    const int room_v = std::min(v, height - 1 - v);
    room_along_ = level ? room_u : room_v;
    room_across_ = static_cast<float>((level ? room_v : room_u) - 1);
  }

  /// Returns whether values `step` px apart are all available.
  [[nodiscard]] bool reaches(int step) const {
    const int far = step * static_cast<int>(kPairs);
    return far <= room_along_ && static_cast<float>(far) * lean_ <= room_across_;
  }
  [[nodiscard]] Line values(int step) const {
    Line line{*pixel_, {}, {}};
    for (std::size_t i = 0; i < kPairs; ++i) {
      const int far = step * static_cast<int>(i + 1);
      const float aside = static_cast<float>(far) * lean_;
      const auto whole = static_cast<int>(aside);
      const float part = aside - static_cast<float>(whole);
      const float* const behind = pixel_ + far * along_ + whole * across_;
      const float* const before = pixel_ - far * along_ - whole * across_;
      line.behind[i] = *behind + part * (behind[across_] - *behind);
      line.before[i] = *before + part * (*(before - across_) - *before);
    }
    return line;
  }
  /// Returns the square of the line's length per pixel along its axis.
  [[nodiscard]] float stretch() const { return 1.0F + lean_ * lean_; }

 private:
  const float* pixel_;
  std::ptrdiff_t along_;
  std::ptrdiff_t across_;
  float lean_ = 0.0F;
  int room_along_;
  float room_across_;
};

/// Near level or upright edges a mask follows whole pixels for long stretches, and only a longer
/// line shows the subpixel position of the edge. Selects the longest line that a quadratic explains
/// (Lepski's choice of a bandwidth), blended in cases of doubt.
float computeAlongEdge(const AlongEdge& edge, float value_mm, float mm_per_px) {
  float smooth_mm = 0.0F;
  float left = 1.0F;
  for (int step = kLongestStep_px; step > 0 && left > 0.0F; --step) {
    if (!edge.reaches(step)) continue;
    const Line line = edge.values(step);
    const LineFit fit(line);
    const float off_px = fit.off(line) / mm_per_px;
    const float share =
        left * std::clamp((kSurelyBad_px - off_px) / (kSurelyBad_px - kSurelyGood_px), 0.0F, 1.0F);
    const float bend = fit.bend() / (static_cast<float>(step * step) * edge.stretch());
    smooth_mm += share * (fit.middle() - kBent_px2 * bend);
    left -= share;
  }
  return smooth_mm + left * value_mm;
}

}  // namespace

void smoothEdgeDistance(std::vector<float>& distance_mm, int width, int height,
                        const Vec2& mm_per_px) {
  std::vector<float> values(distance_mm.size());
  blur(distance_mm, values, width, height);
  values = distance_mm;
  const auto pixel_mm = static_cast<float>(mm_per_px.mean());
  const float nothing_mm = kNothing_px * pixel_mm;
  const float per_mm = 1.0F / (nothing_mm - kAll_px * pixel_mm);
  for (int v = 1; v + 1 < height; ++v) {
    for (int u = 1; u + 1 < width; ++u) {
      const auto i = static_cast<std::size_t>(std::ptrdiff_t{v} * width + u);
      const float away_mm = std::abs(values[i]);
      if (away_mm >= nothing_mm) continue;
      const float smooth_mm =
          computeAlongEdge(AlongEdge(values, width, height, u, v), values[i], pixel_mm);
      const float share = std::min(per_mm * (nothing_mm - away_mm), 1.0F);
      distance_mm[i] += share * (smooth_mm - values[i]);
    }
  }
}

}  // namespace hapticast
