// SPDX-License-Identifier: MIT
// The encoder's half of a slice: which base values and details give its heights. Thread: any.
#pragma once

#include "common/codec/slice/field.hpp"
#include "common/codec/slice/rough.hpp"

namespace hapticast::codec {

/// Fills base, nodes, details and flags of a field that was reset for an encoder. Then every pixel
/// inside is off by at most half of steps.px.
void analyse(Field& field, const Surroundings& object, const Steps& steps);

/// What a cell costs, roughly, in bits; of a field that was analysed, or of numbers that were
/// coded.
float estimateCost(const Field& field, int cell_x, int cell_y);
float estimateCost(const Numbers& numbers, const Field& field, int cell_x, int cell_y);

}  // namespace hapticast::codec
