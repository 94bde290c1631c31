// SPDX-License-Identifier: MIT
// Encoder side of smooth mode: computes the base values and details (interpolation residuals) of a
// slice. Thread: any.
#pragma once

#include "common/codec/slice/field.hpp"
#include "common/codec/slice/rough.hpp"

namespace hapticast::codec {

/// Computes base, nodes, details and flags of a field that was reset for an encoder. Every pixel
/// inside then has an error of at most half of steps.px.
void analyse(Field& field, const Surroundings& object, const Steps& steps);

/// Returns the estimated cost of a cell in bits, of an analysed field or of coded numbers.
float estimateCost(const Field& field, int cell_x, int cell_y);
float estimateCost(const Numbers& numbers, const Field& field, int cell_x, int cell_y);

}  // namespace hapticast::codec
