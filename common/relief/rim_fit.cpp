// SPDX-License-Identifier: MIT
#include "common/relief/rim_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "common/least_squares.hpp"

namespace hapticast {

namespace {
constexpr int kRadius_px = 5;
constexpr double kSigma_px = 2.5;
constexpr double kBendReach_px = 4.0;
constexpr double kReach_px = 12.0;
constexpr double kLimit_mm = 2.0;
// Ridge parameters, relative to the weight of the pixels. The slope's ridge only affects masks that
// do not determine a slope (one pixel, a line). The curvature's ridge prevents a parabola through
// three noisy pixels.
constexpr double kSlopeRidge = 1e-6;
constexpr double kBendRidge = 3e-3;

/// w x^0 .. w x^4 of one offset; x in units of sigma.
using Powers = std::array<double, 5>;

std::array<Powers, 2 * kRadius_px + 1> makePowers() {
  std::array<Powers, 2 * kRadius_px + 1> table{};
  for (int k = -kRadius_px; k <= kRadius_px; ++k) {
    const double x = k / kSigma_px;
    double power = std::exp(-0.5 * x * x);
    for (double& entry : table[static_cast<std::size_t>(k + kRadius_px)]) {
      entry = power;
      power *= x;
    }
  }
  return table;
}
const std::array<Powers, 2 * kRadius_px + 1> kPowers = makePowers();

struct Moments {
  double of_weight[5][5] = {};  // [power of x][power of y]
  double of_height[3][3] = {};
};

Moments gather(const std::vector<float>& height_mm, const std::vector<std::uint8_t>& mask,
               int width, int height, int u, int v) {
  Moments moments;
  const int first = std::max(u - kRadius_px, 0);
  const int last = std::min(u + kRadius_px, width - 1);
  for (int y = std::max(v - kRadius_px, 0); y <= std::min(v + kRadius_px, height - 1); ++y) {
    Powers row{};
    std::array<double, 3> row_height{};
    for (int x = first; x <= last; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(x);
      if (mask[i] == 0) continue;
      const Powers& power = kPowers[static_cast<std::size_t>(x - u + kRadius_px)];
      const auto h = static_cast<double>(height_mm[i]);
      for (std::size_t k = 0; k < 5; ++k) row[k] += power[k];
      for (std::size_t k = 0; k < 3; ++k) row_height[k] += power[k] * h;
    }
    const Powers& power = kPowers[static_cast<std::size_t>(y - v + kRadius_px)];
    for (std::size_t k = 0; k < 5; ++k) {
      for (std::size_t m = 0; m + k < 5; ++m) moments.of_weight[k][m] += row[k] * power[m];
    }
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t m = 0; m + k < 3; ++m) moments.of_height[k][m] += row_height[k] * power[m];
    }
  }
  return moments;
}
}  // namespace

RimFit::RimFit(const std::vector<float>& height_mm, const std::vector<std::uint8_t>& mask,
               int width, int height, int u, int v) {
  static constexpr int kX[6] = {0, 1, 0, 2, 1, 0};  // powers of the basis 1, x, y, x², xy, y²
  static constexpr int kY[6] = {0, 0, 1, 0, 1, 2};
  const Moments moments = gather(height_mm, mask, width, height, u, v);
  Eigen::Matrix<double, 6, 6> normal;
  Eigen::Matrix<double, 6, 1> right;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) normal(i, j) = moments.of_weight[kX[i] + kX[j]][kY[i] + kY[j]];
    right(i) = moments.of_height[kX[i]][kY[i]];
  }
  const double weight = normal(0, 0);
  for (int i = 1; i < 6; ++i) normal(i, i) += weight * (i < 3 ? kSlopeRidge : kBendRidge);
  const Eigen::Matrix<double, 6, 1> fit = solveNormal(normal, right);
  mean_mm_ = right(0) / weight;
  constant_ = fit(0);
  slope_u_ = fit(1) / kSigma_px;
  slope_v_ = fit(2) / kSigma_px;
  bend_uu_ = fit(3) / (kSigma_px * kSigma_px);
  bend_uv_ = fit(4) / (kSigma_px * kSigma_px);
  bend_vv_ = fit(5) / (kSigma_px * kSigma_px);
}

double RimFit::at(double du, double dv) const {
  const double distance = std::sqrt(du * du + dv * dv);
  if (distance == 0.0) return constant_;
  const double a = du / distance;
  const double b = dv / distance;
  const double reach = std::min(distance, kReach_px);
  const double bend_reach = std::min(distance, kBendReach_px);
  const double slope = slope_u_ * a + slope_v_ * b;
  const double bend = bend_uu_ * a * a + bend_uv_ * a * b + bend_vv_ * b * b;
  const double h = constant_ + slope * reach + bend * bend_reach * (2.0 * reach - bend_reach);
  return std::clamp(h, mean_mm_ - kLimit_mm, mean_mm_ + kLimit_mm);
}

}  // namespace hapticast
