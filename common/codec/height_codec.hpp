// SPDX-License-Identifier: MIT
// Heights in few bytes with a hard bound on their error: a relief as slices, rectangles of 8 x 8 px
// cells with their part of the mask, each of which fits a datagram and is decoded alone, in any
// order (proto/README.md, byte by byte). Thread: one; both keep their working memory.
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

/// With the coarse step below it adds less than half a point to the force's error
/// (hapticast-evaluate codec).
inline constexpr double kDefaultHeightError_mm = 0.02;
/// With a datagram's header and signature, and the names of its object and relief, this stays below
/// IPv6's least MTU of 1280 bytes.
inline constexpr std::size_t kMostSliceBytes = 1100;

struct SliceSettings {
  double error_mm = kDefaultHeightError_mm;  ///< of any pixel; 0.002..0.499
  /// 1..16: less is a smoother surface of the same bound, and more bytes. At 16 slices add 0.75
  /// points to the error of the force where they add 0.49 at 10, for 11 % more bytes
  /// (measured).
  int coarse_sixteenths = 10;
  std::size_t most_bytes = kMostSliceBytes;  ///< 300 or more

  bool operator==(const SliceSettings&) const = default;
};

using SliceBytes = std::vector<std::uint8_t>;

class HeightEncoder {
 public:
  /// The relief's slices; none where its mask is empty. Heights beyond -1..1000 mm are taken as
  /// those limits, what is no number as 0. Requires mask and heights of the rectangle's size, at
  /// most 1920 x 1080.
  [[nodiscard]] std::vector<SliceBytes> encode(const Relief& relief,
                                               const SliceSettings& settings = {});

 private:
  /// In cells of the relief.
  struct Part {
    int x = 0, y = 0, width = 0, height = 0;
  };

  void load(const Relief& relief);
  SliceBytes code(const Part& part);
  SliceBytes codeSmooth(const Part& part);
  /// Empty where there are too many levels.
  SliceBytes codeRough(const Part& part);
  [[nodiscard]] codec::Surroundings around(const Part& part);
  void beginSlice(const Part& part, const codec::Shape& shape);
  [[nodiscard]] codec::Header makeHeader(const Part& part, codec::Mode mode) const;

  void codeOrSplit(const Part& wanted, std::vector<SliceBytes>& out);
  void split(const Part& part, int pieces, std::vector<SliceBytes>& out);
  [[nodiscard]] std::ptrdiff_t offset(const Part& part) const;
  [[nodiscard]] bool holdsPixels(const Part& part) const;
  [[nodiscard]] std::size_t countPixels(const Part& part) const;
  [[nodiscard]] Part trimmed(Part part) const;
  [[nodiscard]] std::vector<float> estimateLineCosts(const Part& part, bool across) const;

  SliceSettings settings_;
  int width_px_ = 0, height_px_ = 0;
  Part whole_;
  std::ptrdiff_t stride_ = 0;
  std::vector<std::int32_t> target_;  ///< heights in units, with a margin
  std::vector<std::uint8_t> mask_;    ///< the same
  std::vector<float> costs_;          ///< bits of each cell
  codec::Field field_;
  codec::Numbers numbers_;
};

class HeightDecoder {
 public:
  /// Which pixels of an object's rectangle a slice says something about, by its first bytes alone.
  [[nodiscard]] static Result<PixelRect, WireError> covers(std::span<const std::uint8_t> slice,
                                                           const PixelRect& object);

  /// Writes the pixels that the slice covers, mask and heights (0 outside), into `relief`, and
  /// returns which. On an error nothing is written. Time and memory are bounded by the covered
  /// pixels. Requires mask and heights of the rectangle's size, at most 1920 x 1080.
  [[nodiscard]] Result<PixelRect, WireError> decode(std::span<const std::uint8_t> slice,
                                                    Relief& relief);

 private:
  codec::Field field_;
  codec::Numbers numbers_;
};

}  // namespace hapticast
