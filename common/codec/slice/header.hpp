// SPDX-License-Identifier: MIT
// Header of a slice (proto/README.md). Thread: any.
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

/// Coding modes: interpolation pyramid (smooth), prediction from neighbour pixels (rough).
enum class Mode : std::uint8_t { kSmooth = 0, kRough = 1 };

/// Fields of the header.
struct Header {
  Mode mode = Mode::kSmooth;
  int sixteenths = 16;        ///< coarse step in sixteenths of `step`, 1..16
  int x = 0, y = 0;           ///< first cell, within the object
  int columns = 0, rows = 0;  ///< cells
  int step = 0;               ///< quantiser step of pixels, units

  /// Appends the header's bytes to `out`.
  void write(std::vector<std::uint8_t>& out) const;
  /// Reads the header and checks all fields against the object's rectangle.
  static Result<Header, WireError> read(std::span<const std::uint8_t> slice,
                                        const PixelRect& object);
  /// Returns the size of the slice in cells and pixels.
  [[nodiscard]] Shape shape(const PixelRect& object) const;
};

/// Returns the largest odd step whose half, with the rounding to units, stays within `error_mm`.
inline int stepFor(double error_mm) {
  const double units = std::clamp(error_mm, 0.0, 1.0) * kUnitsPerMm;
  return std::clamp(2 * static_cast<int>(std::floor(units - 0.5)) + 1, kLeastStep, kMostStep);
}

}  // namespace hapticast::codec
