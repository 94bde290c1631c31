// SPDX-License-Identifier: MIT
// The encoder's half of a slice: which base values and details give its heights. Thread: any.
#pragma once

#include "common/wire/slice/field.hpp"

namespace hapticast::codec {

/// Fills base, nodes, details and flags of a field that was reset for an encoder. `target`: the
/// heights, laid out as the mask. Then every pixel inside is off by at most half of steps.px.
void analyse(Field& field, const std::int32_t* target, const Steps& steps);

/// What a cell costs, roughly, in bits; of a field that was analysed.
float costOf(const Field& field, int cell_x, int cell_y);

}  // namespace hapticast::codec
