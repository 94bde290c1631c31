// SPDX-License-Identifier: MIT
#include "server/source/solid_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>

namespace hapticast::server {

namespace {

constexpr int kSide = 32;  // side of the lattice, a power of two

std::size_t cell(int x, int y, int z) {
  const auto wrapped = [](int i) { return static_cast<std::size_t>(i & (kSide - 1)); };
  return (wrapped(z) * kSide + wrapped(y)) * kSide + wrapped(x);
}

/// Trilinear interpolation with smoothed weights, for a continuous slope.
float interpolate(const std::vector<float>& lattice, const Vec3& p) {
  std::array<int, 3> base{};
  std::array<float, 3> w{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double floor = std::floor(p[static_cast<Eigen::Index>(i)]);
    const auto t = static_cast<float>(p[static_cast<Eigen::Index>(i)] - floor);
    base[i] = static_cast<int>(floor);
    w[i] = t * t * (3.0F - 2.0F * t);
  }
  const int x = base[0];
  const int y = base[1];
  const int z = base[2];
  const auto along = [&](int dy, int dz) {
    return std::lerp(lattice[cell(x, y + dy, z + dz)], lattice[cell(x + 1, y + dy, z + dz)], w[0]);
  };
  return std::lerp(std::lerp(along(0, 0), along(1, 0), w[1]),
                   std::lerp(along(0, 1), along(1, 1), w[1]), w[2]);
}

}  // namespace

SolidNoise::SolidNoise() : lattice_(static_cast<std::size_t>(kSide * kSide * kSide)) {
  std::mt19937 random(20);
  // Not a std distribution: their results differ between standard libraries.
  std::generate(lattice_.begin(), lattice_.end(),
                [&] { return static_cast<float>(random() >> 8U) * 0x1p-24F; });
}

float SolidNoise::at(const Vec3& position_mm) const noexcept {
  const float sum = 0.45F * interpolate(lattice_, position_mm / 24.0) +
                    0.35F * interpolate(lattice_, position_mm / 12.0) +
                    0.20F * interpolate(lattice_, position_mm / 6.0);
  // The sum of octaves concentrates around 0.5; this spreads it.
  return std::clamp(0.5F + 1.9F * (sum - 0.5F), 0.0F, 1.0F);
}

}  // namespace hapticast::server
