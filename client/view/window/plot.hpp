// SPDX-License-Identifier: MIT
// Plots of the last seconds in the panel.
// Thread: main.
#pragma once

#include <imgui.h>

#include <span>

#include "client/view/force_history.hpp"

namespace hapticast::client {

/// One line of a plot.
struct Curve {
  double ForcePoint::*value;
  ImU32 color;
};

/// Draws the curves from 0 to `most`, as wide as the panel.
void plot(const ForceHistory& history, double most, const char* unit, float height,
          std::span<const Curve> curves);

/// Returns a round number, at least `least`, above all values in the plotted time.
[[nodiscard]] double upperEnvelope(const ForceHistory& history, double ForcePoint::*value,
                                   double least);

}  // namespace hapticast::client
