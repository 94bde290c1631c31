// SPDX-License-Identifier: MIT
// Reliefs for the height codec: what is exact in every arithmetic (golden bytes), and anything at
// all (properties).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "common/haptic_frame.hpp"

namespace hapticast::testing {

inline Relief emptyRelief(int width, int height) { return Relief::blank({0, 0, width, height}); }

/// `at(x, y)`: a height, or less than -100 where there is none.
template <class HeightAt>
Relief reliefOf(int width, int height, HeightAt at) {
  Relief out = emptyRelief(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y * width + x);
      const auto mm = static_cast<float>(at(x, y));
      out.mask[i] = mm < -100.0F ? 0 : 1;
      out.height_mm[i] = out.mask[i] != 0 ? mm : 0.0F;
    }
  }
  return out;
}

/// A bowl upside down with a hole in it.
inline Relief dome(int width, int height) {
  return reliefOf(width, height, [=](int x, int y) {
    const double u = (x - 0.5 * width) / (0.5 * width);
    const double v = (y - 0.5 * height) / (0.5 * height);
    const bool hole = std::abs(x - width / 3) + std::abs(y - height / 2) < 5;
    return u * u + v * v < 1.0 && !hole ? 20.0 * (1.0 - 0.7 * (u * u + v * v)) : -1e3;
  });
}

/// A sensor's steps of 1/8 mm on a slope, shaken by up to a step.
inline Relief terraces(int width, int height) {
  std::uint32_t state = 1;
  return reliefOf(width, height, [=](int x, int y) mutable {
    state = state * 1664525U + 1013904223U;
    const int noise = static_cast<int>(state >> 30U) / 2;
    const int step = (3 * x + y) / 8 + noise;
    return x + y < 6 ? -1e3 : 0.125 * double(step);
  });
}

/// Any mask and any heights: blobs, bars, dust; planes, waves, noise, jumps.
inline Relief anyRelief(std::mt19937& random, int width, int height) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const double dust = std::pow(share(random), 3.0);
  const double noise_mm = share(random) < 0.5 ? 0.0 : std::pow(10.0, 4.0 * share(random) - 3.0);
  const double wave_px = 2.0 + 60.0 * share(random);
  const double jump_mm = share(random) < 0.5 ? 0.0 : 500.0 * share(random);
  const double reach = 0.2 + share(random);
  const Vec2 middle(width * share(random), height * share(random));
  return reliefOf(width, height, [&](int x, int y) {
    const double far = (Vec2(x, y) - middle).norm() / (0.5 * std::max(width, height));
    if (far > reach || share(random) < dust) return -1e3;
    const double wave = 3.0 * std::sin(x / wave_px) * std::cos(y / wave_px);
    const double jump = x > 2 * y ? jump_mm : 0.0;
    const double mm = 15.0 + wave + jump + noise_mm * (share(random) - 0.5);
    return std::clamp(mm, -1.0, 1000.0);
  });
}

}  // namespace hapticast::testing
