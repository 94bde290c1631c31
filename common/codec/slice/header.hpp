// SPDX-License-Identifier: MIT
// Header of a slice: how it is coded, and which cells it covers (proto/slices.md). Thread: any.
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

/// Modes of a slice. Smooth mode uses the interpolation pyramid. Rough mode predicts each pixel
/// from its neighbours.
enum class Mode : std::uint8_t { kSmooth = 0, kRough = 1 };

/// The header of a slice.
struct Header {
  Mode mode = Mode::kSmooth;
  int sixteenths = 16;        ///< step of the coarser points in sixteenths of `step`, 1..16
  int x = 0, y = 0;           ///< first cell, counted within the object's rectangle
  int columns = 0, rows = 0;  ///< cells
  int step = 0;               ///< quantiser step of the pixels, in units

  /// Appends the header's bytes to `out`.
  void write(std::vector<std::uint8_t>& out) const;
  /// Reads the header of `slice`. Returns an error if a value is invalid for the object's rectangle
  /// `object`.
  static Result<Header, WireError> read(std::span<const std::uint8_t> slice,
                                        const PixelRect& object);
  /// Returns the size of the slice in cells and in pixels. `object` is the object's rectangle.
  [[nodiscard]] Shape shape(const PixelRect& object) const;
};

/// Returns the quantiser step of the pixels for the error bound `error_mm`. The step is in units,
/// the integers of 1 / kUnitsPerMm mm in which the codec stores heights. It is the largest odd step
/// whose half does not exceed the bound. The bound includes the rounding of heights to units.
inline int computeStep(double error_mm) {
  const double units = std::clamp(error_mm, 0.0, 1.0) * kUnitsPerMm;
  return std::clamp(2 * static_cast<int>(std::floor(units - 0.5)) + 1, kLeastStep, kMostStep);
}

}  // namespace hapticast::codec
