// SPDX-License-Identifier: MIT
// Rough mode of a slice, for heights that are not smooth (a sensor's steps and noise). Each pixel
// has one of a few heights, the levels. A slice begins with its levels: evenly spaced heights, or
// the heights that occur. Then it has the index of each pixel's level. The median edge detector
// (LOCO-I, Weinberger et al. 2000) predicts each index. One template encodes and decodes
// (range_coder.hpp). Thread: any.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/codec/slice/field.hpp"
#include "common/codec/slice/range_coder.hpp"

namespace hapticast::codec {

/// Heights of the levels in units, in ascending order.
using Levels = std::vector<std::int32_t>;

inline constexpr std::size_t kMostLevels = 65536;

/// Encodes or decodes the levels. `usual_gap` is the expected distance of two levels. Returns false
/// if there are too many levels, if they do not ascend, or if one exceeds the range of heights.
template <class Coder>
bool codeLevels(Coder& coder, Levels& levels, std::int32_t usual_gap) {
  NumberModel first;
  NumberModel count;
  NumberModel change;
  const std::int32_t lowest = Coder::kDecodes ? 0 : levels.front();
  std::int32_t height = codeNumber(coder, first, lowest);
  const auto wanted = static_cast<int>(Coder::kDecodes ? 0 : levels.size());
  const auto size = static_cast<std::size_t>(codeMagnitude(coder, count, nullptr, wanted));
  if (size > kMostLevels || std::abs(height) > kHighest) return false;
  if constexpr (Coder::kDecodes) levels.assign(1, height);
  std::int32_t gap = usual_gap;
  for (std::size_t i = 1; i < size; ++i) {
    const std::int32_t next = Coder::kDecodes ? 0 : levels[i] - levels[i - 1];
    gap += codeNumber(coder, change, next - gap);
    height += gap;
    if (gap < 1 || height > kHighest) return false;
    if constexpr (Coder::kDecodes) levels.push_back(height);
  }
  return true;
}

/// Probability models of rough mode.
struct RoughModels {
  /// Models of the prediction error. The first index is Around::unrest(). The second index is a
  /// class of the errors of the pixels to the left and above.
  std::array<std::array<NumberModel, 3>, 7> rest;
  std::array<BitModel, 9> sign;  ///< models of the prediction error's sign, by Around::fall()
};

/// Level indices of four pixels around a pixel.
struct Around {
  std::int32_t left, up, up_left, up_right;

  /// Returns the predicted index: the median of left, up, and left + up - up_left.
  [[nodiscard]] std::int32_t guess() const {
    if (up_left >= std::max(left, up)) return std::min(left, up);
    if (up_left <= std::min(left, up)) return std::max(left, up);
    return left + up - up_left;
  }
  /// Returns a class (0..6) for the sum of the differences between the four indices.
  [[nodiscard]] std::size_t unrest() const {
    const int sum = std::abs(up_right - up) + std::abs(up - up_left) + std::abs(up_left - left);
    if (sum < 3) return static_cast<std::size_t>(sum);
    return sum < 5 ? 3 : sum < 9 ? 4 : sum < 17 ? 5 : 6;
  }
  /// Returns a class (0..8) for the signs of up - up_left and left - up_left.
  [[nodiscard]] std::size_t fall() const {
    const auto sign = [](int value) { return (value > 0 ? 2 : 0) + (value == 0 ? 1 : 0); };
    return static_cast<std::size_t>(3 * sign(up - up_left) + sign(left - up_left));
  }
};

/// Level index of each pixel, and the size of its prediction error. Both arrays have a margin of
/// one pixel to the left and right of each row, and of one row above.
struct Numbers {
  std::ptrdiff_t stride = 0;
  std::vector<std::int32_t> level;
  std::vector<std::uint8_t> rest;

  /// Prepares a slice of this shape, with all values zero.
  void reset(const Shape& shape) {
    stride = shape.width + 2;
    level.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(shape.height + 1), 0);
    rest.assign(level.size(), 0);
  }
  [[nodiscard]] std::ptrdiff_t at(int x, int y) const { return (y + 1) * stride + x + 1; }
};

/// Returns as few levels as possible such that the height of every pixel inside is within
/// `farthest` units of a level. Writes the level index of each pixel to `numbers`.
Levels findLevels(const Shape& shape, const Surroundings& object, std::int32_t farthest,
                  Numbers& numbers);

/// Returns the level indices of the four pixels around a pixel. For a pixel outside the mask, it
/// uses one of the other indices, or `last` (the index of the last coded pixel). `top`, `at_left`
/// and `at_right` are true if the pixel lies at that border of the slice.
inline Around loadNeighbours(const std::int32_t* level, std::ptrdiff_t stride,
                             const std::uint8_t* inside, std::ptrdiff_t mask_stride, bool top,
                             bool at_left, bool at_right, std::int32_t last) {
  const bool left = !at_left && inside[-1] != 0;
  const bool up = !top && inside[-mask_stride] != 0;
  const bool up_left = !top && !at_left && inside[-mask_stride - 1] != 0;
  const bool up_right = !top && !at_right && inside[-mask_stride + 1] != 0;
  Around out{};
  out.left = left ? level[-1] : up ? level[-stride] : last;
  out.up = up ? level[-stride] : out.left;
  out.up_left = up_left ? level[-stride - 1] : out.up;
  out.up_right = up_right ? level[-stride + 1] : out.up;
  return out;
}

/// Encodes or decodes the level indices of all pixels inside the mask. `most` is the largest index.
template <class Coder>
void codeNumbers(Coder& coder, RoughModels& models, Numbers& numbers, const Shape& shape,
                 const Mask& mask, std::int32_t most) {
  std::int32_t last = 0;
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const std::uint8_t* inside = mask.data + y * mask.stride + x;
      if (*inside == 0) continue;
      std::int32_t* level = numbers.level.data() + numbers.at(x, y);
      std::uint8_t* rest = numbers.rest.data() + numbers.at(x, y);
      const Around around = loadNeighbours(level, numbers.stride, inside, mask.stride, y == 0,
                                           x == 0, x + 1 == shape.width, last);
      const std::int32_t guess = around.guess();
      const int missed = rest[-1] + rest[-numbers.stride];
      NumberModel& model = models.rest[around.unrest()][missed == 0 ? 0 : missed < 3 ? 1 : 2];
      std::int32_t off = 0;
      if (coder.bit(model.zero, *level != guess)) {
        const bool minus = coder.bit(models.sign[around.fall()], *level < guess);
        const std::int32_t size = codeMagnitude(coder, model, nullptr, std::abs(*level - guess));
        off = minus ? -size : size;
      }
      if constexpr (Coder::kDecodes) *level = std::clamp(guess + off, 0, most);
      *rest = static_cast<std::uint8_t>(std::min(std::abs(off), kMostSize));
      last = *level;
    }
  }
}

}  // namespace hapticast::codec
