// SPDX-License-Identifier: MIT
// The first bytes of a slice (proto/README.md). Thread: any.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/codec/slice/field.hpp"
#include "common/geometry.hpp"
#include "common/result.hpp"
#include "common/wire_error.hpp"

namespace hapticast::codec {

inline constexpr std::size_t kHeaderBytes = 7;
inline constexpr int kLeastStep = 9;
inline constexpr int kMostStep = 4095;

enum class Mode : std::uint8_t { kSmooth = 0, kRough = 1 };

struct Header {
  Mode mode = Mode::kSmooth;
  int sixteenths = 16;  ///< the coarse step, of the pixel's
  int x = 0, y = 0;     ///< first cell
  int columns = 0, rows = 0;
  int step = 0;  ///< of pixels, units

  void write(std::vector<std::uint8_t>& out) const;
  /// The header, with everything checked against the object's rectangle.
  static Result<Header, WireError> read(std::span<const std::uint8_t> slice,
                                        const PixelRect& object);
  [[nodiscard]] Shape shape(const PixelRect& object) const;
};

/// The largest odd step whose half, and the rounding to units, stay within the bound.
inline int stepFor(double error_mm) {
  const double units = std::clamp(error_mm, 0.0, 1.0) * kUnitsPerMm;
  return std::clamp(2 * static_cast<int>(std::floor(units - 0.5)) + 1, kLeastStep, kMostStep);
}

}  // namespace hapticast::codec
