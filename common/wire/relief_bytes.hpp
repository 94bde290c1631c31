// SPDX-License-Identifier: MIT
// A relief as it travels: the mask as bits, the heights inside it as 16-bit values with an offset
// and a scale (proto/README.md). Pure functions on bytes; used by common/wire. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "common/haptic_frame.hpp"
#include "common/result.hpp"
#include "common/wire/error.hpp"

namespace hapticast {

/// height = offset_mm + scale_mm * value.
struct HeightScale {
  float offset_mm = 0.0F;
  float scale_mm = 0.0F;
};

inline constexpr float kLowestHeight_mm = -1.0F;  ///< below the picture's plane: only by rounding
inline constexpr float kHighestHeight_mm = 1000.0F;

/// Bytes of a mask: one bit a pixel, every row padded to whole bytes. Requires a non-empty
/// rectangle.
[[nodiscard]] std::size_t maskBytes(const PixelRect& rect) noexcept;

/// Appends the mask (bit 0 = leftmost pixel) and the heights inside it (little-endian, row-major)
/// to the strings. Error of a height: at most half the returned scale. Requires a valid relief.
HeightScale packRelief(const Relief& relief, std::string& mask, std::string& heights);

/// The reverse, with everything checked before anything is allocated: rectangle within 1920 x 1080
/// and not empty, exact sizes, padding bits zero, at least one pixel inside, all heights in
/// -1..1000 mm. Outside the mask the heights are 0.
[[nodiscard]] Result<Relief, WireError> unpackRelief(const PixelRect& rect, HeightScale scale,
                                                     std::span<const std::uint8_t> mask,
                                                     std::span<const std::uint8_t> heights);

}  // namespace hapticast
