// SPDX-License-Identifier: MIT
// Encoder of the height codec: heights to slices. A relief too large for one slice is split by its
// estimated cost. Thread: one for each object.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "common/codec/height_codec.hpp"
#include "common/codec/slice/covered_cells.hpp"
#include "common/codec/slice/header.hpp"
#include "common/codec/slice/mask_coder.hpp"
#include "common/codec/slice/symbols.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

void copyRow(const float* height_mm, const std::uint8_t* inside, int width, std::int32_t* units,
             std::uint8_t* mask) {
  for (int x = 0; x < width; ++x) {
    const float mm = height_mm[x] == height_mm[x] ? height_mm[x] : 0.0F;
    const float height =
        std::min(std::max(mm, limits::kLowestHeight_mm), limits::kHighestHeight_mm);
    const float exact = height * static_cast<float>(codec::kUnitsPerMm);
    units[x] = static_cast<std::int32_t>(exact + (exact < 0.0F ? -0.5F : 0.5F));
    mask[x] = inside[x] != 0 ? 1 : 0;
  }
}

void encodeMask(codec::RangeEncoder& coder, const codec::Field& field) {
  codec::MaskCoder rows(field.shape.width);
  codec::EdgeRow edges;
  for (int y = 0; y < field.shape.height; ++y) {
    codec::findEdges(field.mask.data + y * field.mask.stride, field.shape.width, edges);
    (void)rows.row(coder, edges);
  }
}

}  // namespace

std::vector<SliceBytes> HeightEncoder::encode(const Relief& relief, const SliceSettings& settings) {
  settings_ = settings;
  load(relief);
  std::vector<SliceBytes> out;
  codeOrSplit(whole_, out);
  return out;
}

void HeightEncoder::load(const Relief& relief) {
  width_px_ = relief.rect.width;
  height_px_ = relief.rect.height;
  whole_ = {0, 0, codec::countCells(width_px_), codec::countCells(height_px_)};
  const int rows = whole_.height * codec::kCell_px + 2 * codec::kMargin_px + 1;
  stride_ = whole_.width * codec::kCell_px + 2 * codec::kMargin_px + 16;
  const auto size = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows);
  mask_.assign(size, 0);
  target_.assign(size, 0);
  for (int y = 0; y < height_px_; ++y) {
    const std::ptrdiff_t from = std::ptrdiff_t{y} * width_px_;
    const std::ptrdiff_t to = (y + codec::kMargin_px) * stride_ + codec::kMargin_px;
    copyRow(relief.height_mm.data() + from, relief.mask.data() + from, width_px_,
            target_.data() + to, mask_.data() + to);
  }
  costs_.resize(static_cast<std::size_t>(whole_.width) * static_cast<std::size_t>(whole_.height));
}

bool HeightEncoder::holdsPixels(const Part& part) const {
  for (int y = part.y * codec::kCell_px; y < (part.y + part.height) * codec::kCell_px; ++y) {
    const std::uint8_t* row = mask_.data() + offset({part.x, 0}) + y * stride_;
    const std::uint8_t* end = row + std::ptrdiff_t{part.width} * codec::kCell_px;
    if (std::find(row, end, 1) != end) return true;
  }
  return false;
}

std::ptrdiff_t HeightEncoder::offset(const Part& part) const {
  return (std::ptrdiff_t{part.y} * codec::kCell_px + codec::kMargin_px) * stride_ +
         std::ptrdiff_t{part.x} * codec::kCell_px + codec::kMargin_px;
}

HeightEncoder::Part HeightEncoder::trimPart(Part part) const {
  while (part.height > 0 && !holdsPixels({part.x, part.y, part.width, 1})) {
    ++part.y;
    --part.height;
  }
  if (part.height == 0) return part;
  while (!holdsPixels({part.x, part.y + part.height - 1, part.width, 1})) --part.height;
  while (!holdsPixels({part.x, part.y, 1, part.height})) {
    ++part.x;
    --part.width;
  }
  while (!holdsPixels({part.x + part.width - 1, part.y, 1, part.height})) --part.width;
  return part;
}

codec::Header HeightEncoder::makeHeader(const Part& part, codec::Mode mode) const {
  return {mode,        settings_.coarse_sixteenths,           part.x, part.y, part.width,
          part.height, codec::computeStep(settings_.error_mm)};
}

codec::Surroundings HeightEncoder::makeSurroundings(const Part& part) {
  return {{mask_.data() + offset(part), stride_}, target_.data() + offset(part)};
}

void HeightEncoder::beginSlice(const Part& part, const codec::Shape& shape) {
  field_.begin(shape);
  for (int y = 0; y < shape.height; ++y) {
    const std::uint8_t* row = mask_.data() + offset(part) + y * stride_;
    std::copy(row, row + shape.width, field_.mask.data + y * field_.mask.stride);
  }
}

SliceBytes HeightEncoder::codeSmooth(const Part& part) {
  const codec::Header header = makeHeader(part, codec::Mode::kSmooth);
  const codec::Shape shape = header.shape({0, 0, width_px_, height_px_});
  const auto steps = codec::Steps::from(header.step, header.sixteenths);
  beginSlice(part, shape);
  field_.reset(true);
  codec::analyse(field_, makeSurroundings(part), steps);
  SliceBytes out;
  out.reserve(2 * kMostSliceBytes);
  header.write(out);
  codec::RangeEncoder coder(out);
  encodeMask(coder, field_);
  codec::SymbolModels models;
  codec::codeHeights(coder, models, field_, steps);
  coder.finish();
  return out;
}

SliceBytes HeightEncoder::codeRough(const Part& part) {
  const codec::Header header = makeHeader(part, codec::Mode::kRough);
  const codec::Shape shape = header.shape({0, 0, width_px_, height_px_});
  beginSlice(part, shape);
  numbers_.reset(shape);
  codec::Levels levels =
      codec::findLevels(shape, makeSurroundings(part), header.step / 2, numbers_);
  if (levels.size() > codec::kMostLevels) return {};
  SliceBytes out;
  header.write(out);
  codec::RangeEncoder coder(out);
  encodeMask(coder, field_);
  (void)codec::codeLevels(coder, levels, header.step);
  codec::RoughModels models;
  codec::codeNumbers(coder, models, numbers_, shape, field_.mask,
                     static_cast<std::int32_t>(levels.size()) - 1);
  coder.finish();
  return out;
}

SliceBytes HeightEncoder::code(const Part& part) {
  SliceBytes smooth = codeSmooth(part);
  // Below one bit for each pixel, rough mode was never shorter (measured).
  if (8 * smooth.size() < countPixels(part)) return smooth;
  SliceBytes rough = codeRough(part);
  return !rough.empty() && rough.size() < smooth.size() ? rough : smooth;
}

std::size_t HeightEncoder::countPixels(const Part& part) const {
  std::size_t sum = 0;
  for (int y = 0; y < part.height * codec::kCell_px; ++y) {
    const std::uint8_t* row = mask_.data() + offset(part) + y * stride_;
    sum = std::accumulate(row, row + std::ptrdiff_t{part.width} * codec::kCell_px, sum);
  }
  return sum;
}

void HeightEncoder::codeOrSplit(const Part& wanted, std::vector<SliceBytes>& out) {
  const Part part = trimPart(wanted);
  if (part.height == 0) return;
  SliceBytes bytes = code(part);
  const bool rough = codec::Mode{static_cast<std::uint8_t>(bytes[0] >> 4U)} == codec::Mode::kRough;
  if (bytes.size() <= settings_.most_bytes || (part.width == 1 && part.height == 1)) {
    out.push_back(std::move(bytes));
    return;
  }
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x)
      costs_[static_cast<std::size_t>((part.y + y) * whole_.width + part.x + x)] =
          rough ? codec::estimateCost(numbers_, field_, x, y) : codec::estimateCost(field_, x, y);
  }
  // Each slice adapts its models anew, and no split is exact.
  const double pieces =
      1.09 * static_cast<double>(bytes.size()) / static_cast<double>(settings_.most_bytes);
  split(part, std::max(2, static_cast<int>(std::ceil(pieces))), out);
}

void HeightEncoder::split(const Part& part, int pieces, std::vector<SliceBytes>& out) {
  if (pieces == 1 || (part.width == 1 && part.height == 1)) return codeOrSplit(part, out);
  const bool across = part.width >= part.height;
  const int lines = across ? part.width : part.height;
  const std::vector<float> costs = estimateLineCosts(part, across);
  const float total = std::accumulate(costs.begin(), costs.end(), 0.0F);
  const int before_line = pieces / 2;
  const float share = total * static_cast<float>(before_line) / static_cast<float>(pieces);
  int line = 1;
  float before = costs[0];
  // A line belongs to the side that it brings nearer to its share.
  while (line < lines - 1 && before + 0.5F * costs[static_cast<std::size_t>(line)] < share)
    before += costs[static_cast<std::size_t>(line++)];
  Part first = part;
  Part second = part;
  (across ? first.width : first.height) = line;
  (across ? second.x : second.y) += line;
  (across ? second.width : second.height) -= line;
  split(first, before_line, out);
  split(second, pieces - before_line, out);
}

std::vector<float> HeightEncoder::estimateLineCosts(const Part& part, bool across) const {
  std::vector<float> out(static_cast<std::size_t>(across ? part.width : part.height), 0.0F);
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x)
      out[static_cast<std::size_t>(across ? x : y)] +=
          costs_[static_cast<std::size_t>((part.y + y) * whole_.width + part.x + x)];
  }
  return out;
}

}  // namespace hapticast
