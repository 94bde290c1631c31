// SPDX-License-Identifier: MIT
// The parts of the topic `accuracy`: cases that each measure a few rows by themselves, so that two
// threads can share them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/evaluate/report.hpp"
#include "tests/evaluate/touch/touch_hands.hpp"

namespace hapticast::evaluate {

struct Outcome {
  std::vector<Row> rows;
  std::vector<Goal> goals;
};
using Case = std::function<Outcome()>;

/// Stiffness that turns a displacement into a force.
inline constexpr double kStiffness_N_mm = 0.5;

/// One scene as our server and as the thesis's makes it.
struct Streams {
  Stream ours, theirs;
  [[nodiscard]] const Stream& of(Method method) const {
    return method == Method::kThesis ? theirs : ours;
  }
};
Streams makeStreams(const TouchScene& scene, StreamKind kind = {});
/// Every variant on its stream, in the order of allVariants().
std::vector<ForceTrace> renderTraces(const Streams& streams, const std::vector<Variant>& variants,
                                     const Hand& hand, const PlayTimes& times = {});

Row rowOf(const std::string& scene, const std::string& stage, const Variant& variant, double error,
          const std::string& unit, double tick_us);

std::vector<Case> smoothCases(bool quick);    ///< still, moving, approaching, turning surfaces
std::vector<Case> wallCases(bool quick);      ///< pushes into side walls, presses at rims
std::vector<Case> motionCases(bool quick);    ///< contacts held, steps at frames
std::vector<Case> frictionCases(bool quick);  ///< breakaway and slip
std::vector<Case> loopCases(bool quick);      ///< moving surfaces with device and observer
std::vector<Case> dynamicCases(bool quick);   ///< m a, impacts, inertia of the cursor

}  // namespace hapticast::evaluate
