// SPDX-License-Identifier: MIT
// Decoder of the height codec: slices to heights (encoder: height_encoder.cpp). Thread: one for
// each object.
#include "common/codec/height_codec.hpp"

#include <algorithm>
#include <optional>

#include "common/codec/slice/header.hpp"
#include "common/codec/slice/mask_coder.hpp"
#include "common/codec/slice/rough.hpp"
#include "common/codec/slice/symbols.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

/// Returns the rectangle of a header's pixels within the object's rectangle.
PixelRect computePixelRect(const codec::Header& header, const PixelRect& object) {
  const codec::Shape shape = header.shape(object);
  return {header.x * codec::kCell_px, header.y * codec::kCell_px, shape.width, shape.height};
}

/// Decodes the mask. Returns false if it is empty.
bool decodeMask(codec::RangeDecoder& coder, const codec::Field& field) {
  codec::MaskCoder rows(field.shape.width);
  bool any = false;
  for (int y = 0; y < field.shape.height; ++y) {
    const codec::EdgeRow& edges = rows.row(coder, {});
    for (std::size_t i = 0; i + 1 < edges.size(); i += 2) {
      std::uint8_t* row = field.mask.data + y * field.mask.stride;
      std::fill(row + edges[i].at, row + edges[i + 1].at, std::uint8_t{1});
      any = true;
    }
  }
  return any;
}

void applyPatches(codec::Level& level, const std::vector<codec::Patch>& patches) {
  for (const codec::Patch& patch : patches) {
    std::int32_t& height = level.height[patch.point];
    height = std::clamp(height + patch.change, -codec::kHighest, codec::kHighest);
  }
}

void reconstruct(codec::Field& field, const codec::Steps& steps) {
  field.placeNodes(steps.base);
  for (std::size_t i = 0; i < field.levels.size(); ++i) {
    field.interpolateEven(i);
    applyPatches(field.levels[i], field.levels[i].even);
    field.interpolateOdd(i);
    applyPatches(field.levels[i], field.levels[i].odd);
  }
}

/// Heights in units; undefined outside the mask.
struct Heights {
  const std::int32_t* data = nullptr;
  std::ptrdiff_t stride = 0;
};

std::optional<Heights> decodeSmooth(codec::RangeDecoder& coder, const codec::Header& header,
                                    codec::Field& field) {
  field.reset(false);
  const auto steps = codec::Steps::from(header.step, header.sixteenths);
  codec::SymbolModels models;
  codec::codeHeights(coder, models, field, steps);
  reconstruct(field, steps);
  return Heights{field.levels.back().height.data(), field.levels.back().columns};
}

std::optional<Heights> decodeRough(codec::RangeDecoder& coder, const codec::Header& header,
                                   const codec::Field& field, codec::Numbers& numbers) {
  codec::Levels levels;
  if (!codec::codeLevels(coder, levels, header.step)) return std::nullopt;
  numbers.reset(field.shape);
  codec::RoughModels models;
  codec::codeNumbers(coder, models, numbers, field.shape, field.mask,
                     static_cast<std::int32_t>(levels.size()) - 1);
  for (std::int32_t& number : numbers.level) number = levels[static_cast<std::size_t>(number)];
  return Heights{numbers.level.data() + numbers.at(0, 0), numbers.stride};
}

/// Converts heights from units to mm, row by row; 0 outside the mask.
void writeRow(const std::int32_t* units, const std::uint8_t* mask, int width, float* height_mm,
              std::uint8_t* inside) {
  constexpr float kMmPerUnit = 1.0F / codec::kUnitsPerMm;
  for (int x = 0; x < width; ++x) {
    const float mm = std::clamp(static_cast<float>(units[x]) * kMmPerUnit, limits::kLowestHeight_mm,
                                limits::kHighestHeight_mm);
    height_mm[x] = mm * static_cast<float>(mask[x]);
    inside[x] = mask[x];
  }
}

}  // namespace

Result<PixelRect, WireError> HeightDecoder::covers(std::span<const std::uint8_t> slice,
                                                   const PixelRect& object) {
  const auto header = codec::Header::read(slice, object);
  if (!header.ok()) return header.error();
  return computePixelRect(header.value(), object);
}

Result<PixelRect, WireError> HeightDecoder::decode(std::span<const std::uint8_t> slice,
                                                   Relief& relief) {
  const auto read = codec::Header::read(slice, relief.rect);
  if (!read.ok()) return read.error();
  const codec::Header& header = read.value();
  const codec::Shape shape = header.shape(relief.rect);
  field_.begin(shape);
  codec::RangeDecoder coder(slice.subspan(codec::kHeaderBytes));
  if (!decodeMask(coder, field_)) return malformed("a slice's mask is empty");
  const bool smooth = header.mode == codec::Mode::kSmooth;
  const auto heights =
      smooth ? decodeSmooth(coder, header, field_) : decodeRough(coder, header, field_, numbers_);
  if (!heights) return malformed("a slice's levels are too many or out of range");
  if (coder.isMisled()) return malformed("a slice ends too early");
  const PixelRect pixels = computePixelRect(header, relief.rect);
  for (int y = 0; y < shape.height; ++y) {
    const auto to = static_cast<std::ptrdiff_t>(pixels.v + y) * relief.rect.width + pixels.u;
    writeRow(heights->data + y * heights->stride, field_.mask.data + y * field_.mask.stride,
             shape.width, relief.height_mm.data() + to, relief.mask.data() + to);
  }
  return pixels;
}

}  // namespace hapticast
