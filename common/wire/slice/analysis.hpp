// SPDX-License-Identifier: MIT
// The encoder's half of a slice: which base values and details give its heights. Thread: any.
#pragma once

#include "common/wire/slice/field.hpp"

namespace hapticast::codec {

/// The object around a slice.
struct Surroundings {
  Mask mask;                             ///< of the slice's first pixel, goes on beyond the slice
  const std::int32_t* target = nullptr;  ///< heights in units, laid out as the mask
};

/// Fills base, nodes, details and flags of a field that was reset for an encoder. Then every pixel
/// inside is off by at most half of steps.px.
void analyse(Field& field, const Surroundings& object, const Steps& steps);

/// What a cell costs, roughly, in bits; of a field that was analysed.
float costOf(const Field& field, int cell_x, int cell_y);

}  // namespace hapticast::codec
