// SPDX-License-Identifier: MIT
// Plots of the last seconds in the window's panel. Thread: main.
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

/// Plots from 0 to `most`, as wide as the panel.
void plot(const ForceHistory& history, double most, const char* unit, float height,
          std::span<const Curve> curves);

/// A round number, at least `least`, that what was there in the plotted time stays below.
[[nodiscard]] double upperEnvelope(const ForceHistory& history, double ForcePoint::*value,
                                   double least);

}  // namespace hapticast::client
