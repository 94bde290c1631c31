// SPDX-License-Identifier: MIT
// Height codec: near-lossless compression of a relief with a bounded error for each pixel. A relief
// becomes slices: rectangles of 8 x 8 px cells with their part of the mask.
// A slice fits one datagram and decodes alone, in any order. It is coded by interpolation on a
// pyramid or by pixel prediction, with an adaptive binary range coder. Bytes: proto/README.md.
// Thread: one for each object; both classes reuse their working memory.
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

/// Default bound. Measured (hapticast-evaluate codec): with the coarse step below it adds less than
/// half a point to the force's error.
inline constexpr double kDefaultHeightError_mm = 0.02;
/// Limit of a slice. With a datagram's header and signature, and the ids of its object and relief,
/// it stays below IPv6's least MTU of 1280 bytes.
inline constexpr std::size_t kMostSliceBytes = 1100;

/// Settings of the encoder.
struct SliceSettings {
  double error_mm = kDefaultHeightError_mm;  ///< bound of a pixel's error, 0.002..0.499
  /// Coarse step in sixteenths of the pixel step, 1..16. A smaller step yields a smoother surface
  /// of equal bound, and more bytes. Measured: at 16, slices add 0.75 points to the force's error;
  /// at 10, 0.49 points for 11 % more bytes.
  int coarse_sixteenths = 10;
  std::size_t most_bytes = kMostSliceBytes;  ///< limit of a slice, 300 or more

  bool operator==(const SliceSettings&) const = default;
};

using SliceBytes = std::vector<std::uint8_t>;

/// Encoder of reliefs.
class HeightEncoder {
 public:
  /// Returns the slices of `relief`; none if its mask is empty. Heights are clamped to -1..1000 mm,
  /// and NaN counts as 0. Requires mask and heights of the rectangle's size, at most 1920 x 1080
  /// px.
  [[nodiscard]] std::vector<SliceBytes> encode(const Relief& relief,
                                               const SliceSettings& settings = {});

 private:
  /// A part of the relief, in cells.
  struct Part {
    int x = 0, y = 0, width = 0, height = 0;
  };

  /// Copies the relief to target_ and mask_.
  void load(const Relief& relief);
  /// Codes a part as one slice, in the mode that needs fewer bytes.
  SliceBytes code(const Part& part);
  SliceBytes codeSmooth(const Part& part);
  /// Returns an empty vector if there are too many levels.
  SliceBytes codeRough(const Part& part);
  [[nodiscard]] codec::Surroundings around(const Part& part);
  void beginSlice(const Part& part, const codec::Shape& shape);
  [[nodiscard]] codec::Header makeHeader(const Part& part, codec::Mode mode) const;

  /// Codes a part, split into as many slices as needed.
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
  std::vector<std::uint8_t> mask_;    ///< with the same margin
  std::vector<float> costs_;          ///< estimated bits of each cell
  codec::Field field_;
  codec::Numbers numbers_;
};

/// Decoder of slices.
class HeightDecoder {
 public:
  /// Returns the pixels of an object's rectangle that a slice covers, from its header alone.
  [[nodiscard]] static Result<PixelRect, WireError> covers(std::span<const std::uint8_t> slice,
                                                           const PixelRect& object);

  /// Writes the pixels of the slice, mask and heights (0 outside), to `relief`. Returns their
  /// rectangle. Writes nothing on an error. Time and memory are bounded by the covered pixels.
  /// Requires mask and heights of the rectangle's size, at most 1920 x 1080 px.
  [[nodiscard]] Result<PixelRect, WireError> decode(std::span<const std::uint8_t> slice,
                                                    Relief& relief);

 private:
  codec::Field field_;
  codec::Numbers numbers_;
};

}  // namespace hapticast
