// SPDX-License-Identifier: MIT
#include "common/wire/relief_bytes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace hapticast {

namespace {

constexpr float kSteps = 65535.0F;

std::size_t rowBytes(const PixelRect& rect) noexcept {
  return (static_cast<std::size_t>(rect.width) + 7) / 8;
}

HeightScale scaleOf(const Relief& relief) {
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  for (std::size_t i = 0; i < relief.mask.size(); ++i) {
    if (relief.mask[i] == 0) continue;
    low = std::min(low, relief.height_mm[i]);
    high = std::max(high, relief.height_mm[i]);
  }
  return high >= low ? HeightScale{low, (high - low) / kSteps} : HeightScale{};
}

/// Number of pixels inside, or nothing when a padding bit is set.
std::optional<std::size_t> countInside(const PixelRect& rect, std::span<const std::uint8_t> mask) {
  const std::size_t row_bytes = rowBytes(rect);
  const unsigned used = static_cast<unsigned>(rect.width) % 8;
  const unsigned padding = used == 0 ? 0U : 0xFFU & ~((1U << used) - 1U);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (i % row_bytes == row_bytes - 1 && (mask[i] & padding) != 0) return std::nullopt;
    inside += static_cast<std::size_t>(std::popcount(mask[i]));
  }
  return inside;
}

bool validScale(HeightScale scale) {
  if (!std::isfinite(scale.offset_mm) || !std::isfinite(scale.scale_mm)) return false;
  return scale.scale_mm >= 0.0F && scale.offset_mm >= kLowestHeight_mm &&
         scale.offset_mm + kSteps * scale.scale_mm <= kHighestHeight_mm * 1.0001F;
}

}  // namespace

std::size_t maskBytes(const PixelRect& rect) noexcept {
  return rowBytes(rect) * static_cast<std::size_t>(rect.height);
}

HeightScale packRelief(const Relief& relief, std::string& mask, std::string& heights) {
  const HeightScale scale = scaleOf(relief);
  const float per_mm = scale.scale_mm > 0.0F ? 1.0F / scale.scale_mm : 0.0F;
  const auto width = static_cast<std::size_t>(relief.rect.width);
  const std::size_t row_bytes = rowBytes(relief.rect);
  const auto inside = static_cast<std::size_t>(
      std::count_if(relief.mask.begin(), relief.mask.end(), [](auto m) { return m != 0; }));
  const std::size_t first = mask.size();
  mask.resize(first + maskBytes(relief.rect), '\0');
  heights.reserve(heights.size() + 2 * inside);
  for (std::size_t i = 0; i < relief.mask.size(); ++i) {
    if (relief.mask[i] == 0) continue;
    const std::size_t column = i % width;
    char& byte = mask[first + i / width * row_bytes + column / 8];
    byte = static_cast<char>(static_cast<unsigned char>(byte) | (1U << (column % 8)));
    const float steps = std::round((relief.height_mm[i] - scale.offset_mm) * per_mm);
    const auto value = static_cast<std::uint16_t>(std::clamp(steps, 0.0F, kSteps));
    heights.push_back(static_cast<char>(value & 0xFFU));
    heights.push_back(static_cast<char>(value >> 8U));
  }
  return scale;
}

Result<Relief, WireError> unpackRelief(const PixelRect& rect, HeightScale scale,
                                       std::span<const std::uint8_t> mask,
                                       std::span<const std::uint8_t> heights) {
  if (rect.empty() || rect.u < 0 || rect.v < 0 || rect.u > kMaxWidth_px - rect.width ||
      rect.v > kMaxHeight_px - rect.height) {
    return malformed("a relief's rectangle is empty or leaves 1920 x 1080");
  }
  if (!validScale(scale)) return malformed("a relief's offset or scale is out of range");
  if (mask.size() != maskBytes(rect)) return malformed("a relief's mask has the wrong size");
  const auto inside = countInside(rect, mask);
  if (!inside) return malformed("a relief's mask has padding bits set");
  if (*inside == 0) return malformed("a relief's mask is empty");
  if (heights.size() != 2 * *inside) return malformed("a relief's heights do not fit its mask");

  Relief relief;
  relief.rect = rect;
  const auto width = static_cast<std::size_t>(rect.width);
  const std::size_t pixels = width * static_cast<std::size_t>(rect.height);
  relief.height_mm.assign(pixels, 0.0F);
  relief.mask.assign(pixels, 0);
  const std::size_t row_bytes = rowBytes(rect);
  std::size_t next = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::size_t column = i % width;
    if ((mask[i / width * row_bytes + column / 8] >> (column % 8) & 1U) == 0) continue;
    const unsigned value = heights[next] | static_cast<unsigned>(heights[next + 1]) << 8U;
    next += 2;
    relief.mask[i] = 1;
    relief.height_mm[i] = scale.offset_mm + scale.scale_mm * static_cast<float>(value);
  }
  return relief;
}

}  // namespace hapticast
