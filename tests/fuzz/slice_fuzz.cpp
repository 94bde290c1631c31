// SPDX-License-Identifier: MIT
// HeightDecoder: no bytes crash it, what it accepts is a relief that may be touched, and that
// relief can be sent on within the bound. The first two bytes are the rectangle's size.
#include <cmath>
#include <cstdint>
#include <span>

#include "common/codec/height_codec.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::slice {

HAPTICAST_FUZZ_TARGET("slice") {
  if (size < 2) return 0;
  hapticast::Relief relief = hapticast::Relief::blank({0, 0, data[0] + 1, data[1] + 1});
  hapticast::HeightDecoder decoder;
  if (!decoder.decode(std::span(data + 2, size - 2), relief).ok()) return 0;
  for (const float mm : relief.height_mm) require(mm >= -1.0F && mm <= 1000.0F);
  if (relief.mask.size() > 4096) return 0;  // what is large is slow
  hapticast::HeightEncoder encoder;
  hapticast::Relief again = hapticast::Relief::blank(relief.rect);
  for (const auto& slice : encoder.encode(relief)) {
    require(slice.size() <= hapticast::kMostSliceBytes);
    require(decoder.decode(slice, again).ok());
  }
  require(again.mask == relief.mask);
  for (std::size_t i = 0; i < again.mask.size(); ++i)
    require(std::abs(again.height_mm[i] - relief.height_mm[i]) <= 0.0201F);
  return 0;
}

}  // namespace hapticast::fuzz::slice
