// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/evaluate/accuracy/accuracy_parts.hpp"
#include "tests/evaluate/figures/figures_moments.hpp"
#include "tests/evaluate/figures/figures_parts.hpp"
#include "tests/evaluate/touch/touch_hands.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kRadius_mm = 20.0;
constexpr double kArrow_s = 0.16;  // each has so long
constexpr int kArrows = 25;
constexpr double kSteepest_rad = 75.0 * std::numbers::pi / 180.0;

double slopeOf(int arrow) { return kSteepest_rad * (2.0 * arrow / (kArrows - 1) - 1.0); }

// From outside along the radius to 1 mm below the surface, at one angle after the other.
Hand slicingHand(const Vec3& centre_mm) {
  return [=](double time_s) {
    const int arrow = std::clamp(static_cast<int>((time_s - 0.4) / kArrow_s), 0, kArrows - 1);
    const double since_s = time_s - 0.4 - arrow * kArrow_s;
    const double depth_mm = std::min(1.0, -1.0 + since_s / (0.6 * kArrow_s) * 2.0);
    const double slope = slopeOf(arrow);
    const Vec3 outward(std::sin(slope), 0.0, std::cos(slope));
    HandPoint out;
    out.hip_mm = centre_mm + (kRadius_mm - depth_mm) * outward;
    if (depth_mm > 0) out.truth_mm = depth_mm * outward;
    return out;
  };
}

CurvePanel staticPanel(const ForceTrace& trace, const Vec3& centre_mm, const std::string& title,
                       double& error) {
  SliceArrows truth{"truth", "#909090", 3.0, {}};
  SliceArrows force{"static force", kStaticColor, 1.5, {}};
  std::vector<Moment> all;
  for (int arrow = 0; arrow < kArrows; ++arrow) {
    const double at_s = 0.4 + (arrow + 0.95) * kArrow_s;
    const auto tick = std::find_if(trace.ticks.begin(), trace.ticks.end(),
                                   [&](const Tick& t) { return t.time_s >= at_s; });
    if (tick == trace.ticks.end()) continue;
    const Vec3 from_mm = tick->hand.hip_mm - centre_mm;
    const Vec3 is_N = kStiffness_N_mm * tick->displacement_mm;
    const Vec3 should_N = kStiffness_N_mm * tick->hand.truth_mm;
    truth.forces.emplace_back(from_mm, should_N);
    force.forces.emplace_back(from_mm, is_N);
    all.push_back({0.0, is_N, is_N, should_N, should_N});
  }
  error = errorOf(all, &Moment::static_N, &Moment::true_static_N);
  return slicePanel(title, 0, kRadius_mm, {truth, force});
}

}  // namespace

void drawSlice(const Options& options, Report& report) {
  const TouchScene scene = stillSphere();
  const Vec3 centre_mm = scene.motion(0.0).position_mm;
  const Hand hand = slicingHand(centre_mm);
  std::vector<CurvePanel> panels;
  for (const Variant& variant : allVariants()) {
    const bool wanted = variant.is_default || variant.is_thesis || variant.name == "normal" ||
                        variant.name == "perturbed, K 0";
    if (!wanted) continue;
    StreamKind kind;
    kind.method = variant.method;
    kind.longest_s = 0.4 + kArrows * kArrow_s + 0.3;
    double error = 0;
    const ForceTrace trace = renderTrace(makeStream(scene, kind), variant, hand);
    panels.push_back(staticPanel(trace, centre_mm, variant.name, error));
    report.add({"slice of the ball", "static force", variant.name, error, "%", 0.0,
                variant.is_default, variant.is_thesis});
  }
  plotCurves(options.out / "figure_5.png", panels, 2);
}

}  // namespace hapticast::evaluate
