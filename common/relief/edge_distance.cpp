// SPDX-License-Identifier: MIT
#include "common/relief/edge_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hapticast {

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
float alongEdge(const AlongEdge& edge, float value_mm, float mm_per_px) {
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
          alongEdge(AlongEdge(values, width, height, u, v), values[i], pixel_mm);
      const float share = std::min(per_mm * (nothing_mm - away_mm), 1.0F);
      distance_mm[i] += share * (smooth_mm - values[i]);
    }
  }
}

}  // namespace hapticast
