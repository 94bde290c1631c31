// SPDX-License-Identifier: MIT
#include "common/codec/slice/header.hpp"

#include <algorithm>

namespace hapticast::codec {

void Header::write(std::vector<std::uint8_t>& out) const {
  const auto byte = [](int value) { return static_cast<std::uint8_t>(value); };
  out.insert(out.end(), {byte(static_cast<int>(mode) << 4 | (sixteenths - 1)), byte(x), byte(y),
                         byte(columns), byte(rows), byte(step & 0xFF), byte(step >> 8)});
}

Result<Header, WireError> Header::read(std::span<const std::uint8_t> slice,
                                       const PixelRect& object) {
  if (slice.size() < kHeaderBytes) return malformed("a slice is shorter than its header");
  if (slice[0] >> 4U > static_cast<unsigned>(Mode::kRough))
    return malformed("a slice has an unknown mode");
  Header out{static_cast<Mode>(slice[0] >> 4U),
             static_cast<int>(slice[0] & 15U) + 1,
             slice[1],
             slice[2],
             slice[3],
             slice[4],
             slice[5] | slice[6] << 8};
  if (out.step < kLeastStep || out.step > kMostStep)
    return malformed("a slice's step is out of range");
  if (out.columns < 1 || out.rows < 1 || out.x + out.columns > countCells(object.width) ||
      out.y + out.rows > countCells(object.height))
    return malformed("a slice leaves its object's rectangle");
  return out;
}

Shape Header::shape(const PixelRect& object) const {
  return {columns, rows, std::min(columns * kCell_px, object.width - x * kCell_px),
          std::min(rows * kCell_px, object.height - y * kCell_px)};
}

}  // namespace hapticast::codec
