// SPDX-License-Identifier: MIT
#include "server/settings.hpp"

#include <algorithm>

#include "common/codec/height_codec.hpp"

namespace hapticast::server {

double heightError_mm(const VisionSettings& vision) {
  // Chosen: larger steps between slices are perceptible as edges.
  constexpr double kMost_mm = 0.25;
  const double stiffness_N_mm = vision.material.stiffness_N_mm.value_or(kUsualStiffness_N_mm);
  const double usual_N = kUsualStiffness_N_mm * kDefaultHeightError_mm;
  const double share = vision.plan.error_budget_N / PlanSettings{}.error_budget_N;
  return std::min(share * usual_N / stiffness_N_mm, kMost_mm);
}

}  // namespace hapticast::server
