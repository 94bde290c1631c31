// SPDX-License-Identifier: MIT
// Height codec: near-lossless compression of a relief, with a bounded error for each pixel. It
// divides a relief into slices. A slice is a rectangle of cells of 8 x 8 px, with the heights and
// the mask of its pixels. It fits one datagram, and it can be decoded without the others, in any
// order.
//
// A slice has one of two modes. Smooth mode interpolates the heights on a pyramid of coarser and
// coarser points. Rough mode predicts each pixel from its neighbours. In both modes an adaptive
// binary range coder writes the bytes (proto/slices.md). Thread: any; at most one at a time for
// each object, because both classes reuse their working memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/codec/slice/field.hpp"
#include "common/codec/slice/header.hpp"
#include "common/codec/slice/rough.hpp"
#include "common/haptic_frame.hpp"
#include "common/result.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

/// Default for the largest error of a pixel's height. Its effect was measured (hapticast-evaluate
/// codec): with the default of `coarse_sixteenths`, the codec increases the error of the force by
/// less than half a percentage point.
inline constexpr double kDefaultHeightError_mm = 0.02;
/// Largest size of a slice. A datagram also has its header, its signature, and the ids of object
/// and relief. With all of them it stays below 1280 bytes, the smallest MTU of IPv6.
inline constexpr std::size_t kMostSliceBytes = 1070;
/// Smallest size of a slice: a header of 7 bytes, and at least one byte of code.
inline constexpr std::size_t kLeastSliceBytes = 8;

/// Settings of the encoder.
struct SliceSettings {
  double error_mm = kDefaultHeightError_mm;  ///< largest error of a pixel's height, 0.002..0.499
  /// Quantiser step of the points on the coarser levels of the pyramid (smooth mode), from which
  /// the codec interpolates the pixels. It is in sixteenths of the step of the pixels, 1..16. A
  /// smaller step yields a smoother surface with the same largest error, but needs more bytes. The
  /// effect was measured. At 16, the codec increases the error of the force by 0.75 percentage
  /// points. At 10, it increases that error by 0.49 points, and slices have 11 % more bytes.
  int coarse_sixteenths = 10;
  std::size_t most_bytes = kMostSliceBytes;  ///< largest size of a slice, 300 or more

  bool operator==(const SliceSettings&) const = default;
};

using SliceBytes = std::vector<std::uint8_t>;

/// Encodes reliefs as slices.
class HeightEncoder {
 public:
  /// Returns the slices of `relief`. Returns no slices if its mask is empty. Heights are clamped to
  /// -1..1000 mm, and NaN counts as 0. Requires mask and heights of the size of relief.rect, at
  /// most 1920 x 1080 px.
  [[nodiscard]] std::vector<SliceBytes> encode(const Relief& relief,
                                               const SliceSettings& settings = {});

 private:
  /// A rectangle of the relief, in cells.
  struct Part {
    int x = 0, y = 0, width = 0, height = 0;
  };

  /// Copies the relief to target_ and mask_.
  void load(const Relief& relief);
  /// Returns one slice for `part`, in the mode that needs fewer bytes.
  SliceBytes code(const Part& part);
  SliceBytes codeSmooth(const Part& part);
  /// Returns one slice for `part` in rough mode. Returns an empty vector if the heights need too
  /// many levels.
  SliceBytes codeRough(const Part& part);
  [[nodiscard]] codec::Surroundings makeSurroundings(const Part& part);
  void beginSlice(const Part& part, const codec::Shape& shape);
  [[nodiscard]] codec::Header makeHeader(const Part& part, codec::Mode mode) const;

  /// Appends the slices of `wanted` to `out`. Splits `wanted` into as many slices as necessary.
  void codeOrSplit(const Part& wanted, std::vector<SliceBytes>& out);
  void split(const Part& part, int pieces, std::vector<SliceBytes>& out);
  [[nodiscard]] std::ptrdiff_t offset(const Part& part) const;
  [[nodiscard]] bool holdsPixels(const Part& part) const;
  [[nodiscard]] std::size_t countPixels(const Part& part) const;
  [[nodiscard]] Part trimPart(Part part) const;
  [[nodiscard]] std::vector<float> estimateLineCosts(const Part& part, bool across) const;

  SliceSettings settings_;
  int width_px_ = 0, height_px_ = 0;
  Part whole_;
  std::ptrdiff_t stride_ = 0;
  std::vector<std::int32_t> target_;  ///< heights in units, with a margin
  std::vector<std::uint8_t> mask_;    ///< the mask, with the same margin
  std::vector<float> costs_;          ///< estimated bits of each cell
  codec::Field field_;
  codec::Numbers numbers_;
};

/// Decodes slices into a relief.
class HeightDecoder {
 public:
  /// Returns the rectangle of pixels that the slice covers. The rectangle is relative to the
  /// top-left pixel of `object`, the rectangle of the whole relief. The function reads only the
  /// header of the slice. Returns an error if the header is invalid.
  [[nodiscard]] static Result<PixelRect, WireError> covers(std::span<const std::uint8_t> slice,
                                                           const PixelRect& object);

  /// Decodes `slice` and writes its pixels to `relief`: the mask, and the heights (0 outside the
  /// mask). Returns the rectangle of these pixels, relative to relief.rect. If it returns an error,
  /// `relief` is unchanged. Time and memory are bounded by the number of covered pixels. Requires
  /// mask and heights of the size of relief.rect, at most 1920 x 1080 px.
  [[nodiscard]] Result<PixelRect, WireError> decode(std::span<const std::uint8_t> slice,
                                                    Relief& relief);

 private:
  codec::Field field_;
  codec::Numbers numbers_;
};

}  // namespace hapticast
