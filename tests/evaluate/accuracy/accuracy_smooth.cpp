// SPDX-License-Identifier: MIT
// Smooth surfaces under a sliding hand: the error of every way to the force, and where that of the
// default comes from.
#include <algorithm>
#include <cmath>

#include "tests/evaluate/accuracy/accuracy_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kSourcesLong_s = 8.0;

struct SmoothCase {
  TouchScene scene;
  double reach_mm = 0.0;  ///< of the hand, from the reference point
  std::string stage;
  double required = 0.0, aim = 0.0;  ///< %
  double longest_s = 1e9;
};

// Noise of the force that the surface does not have: rms per tick.
double roughness_mN(const std::vector<Tick>& ticks) {
  double square = 0;
  std::size_t count = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (!ticks[i].trulyTouches() || !ticks[i - 1].trulyTouches()) continue;
    square += (ticks[i].error_mm() - ticks[i - 1].error_mm()).squaredNorm();
    ++count;
  }
  return 1e3 * kStiffness_N_mm * std::sqrt(square / std::max<double>(1.0, double(count)));
}

// The default on streams that leave out one error or the other.
void addSources(const SmoothCase& what, const Hand& hand, Outcome& out) {
  struct Source {
    const char* name;
    bool eight_bit, exact_pose;
  };
  for (const Source& source : {Source{"exact heights, measured pose", false, false},
                               Source{"8 bit, exact pose", true, true}}) {
    StreamKind kind;
    kind.seen.eight_bit = source.eight_bit;
    kind.exact_pose = source.exact_pose;
    kind.longest_s = std::min(kSourcesLong_s, what.longest_s);
    const ForceTrace trace = renderTrace(makeStream(what.scene, kind), defaultVariant(), hand);
    out.rows.push_back({what.scene.name, "where the error comes from", source.name,
                        100.0 * relativeError(trace.ticks), "%", 0.0, false, false});
  }
}

void addOwnMask(const SmoothCase& what, const Hand& hand, Outcome& out) {
  StreamKind kind;
  kind.seen.give_mask = false;
  kind.longest_s = std::min(kSourcesLong_s, what.longest_s);
  const Streams streams = makeStreams(what.scene, kind);
  for (const Variant& variant : {defaultVariant(), thesisVariant()}) {
    const Stream& stream = streams.of(variant.method);
    const ForceTrace trace = renderTrace(stream, variant, hand);
    out.rows.push_back(rowOf(what.scene.name, "force, own mask", variant,
                             100.0 * relativeError(trace.ticks), "%", 0.0));
    out.rows.push_back(
        rowOf(what.scene.name, "own mask off by", variant, stream.mask_error_px, "px", 0.0));
  }
}

Outcome measure(const SmoothCase& what, bool quick) {
  Outcome out;
  const Hand hand = slidingHand(what.scene, what.reach_mm);
  StreamKind kind;
  kind.longest_s = what.longest_s;
  Goal goal{what.scene.name, "%", what.required, what.aim};
  const std::vector<Variant> variants = allVariants();
  const std::vector<ForceTrace> all = renderTraces(makeStreams(what.scene, kind), variants, hand);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const Variant& variant = variants[i];
    const ForceTrace& trace = all[i];
    const double error = 100.0 * relativeError(trace.ticks);
    out.rows.push_back(rowOf(what.scene.name, what.stage, variant, error, "%", trace.tick_us));
    out.rows.push_back(rowOf(what.scene.name, "roughness of the force", variant,
                             roughness_mN(trace.ticks), "mN per tick", trace.tick_us));
    if (variant.is_default) goal.got = error;
    if (variant.is_thesis) goal.thesis = error;
  }
  out.goals.push_back(goal);
  if (quick) return out;
  addSources(what, hand, out);
  addOwnMask(what, hand, out);
  return out;
}

}  // namespace

std::vector<Case> smoothCases(bool quick) {
  const char* const still = "force, still surface";
  const char* const moving = "force, moving surface";
  const double long_s = quick ? 6.0 : 40.0;
  std::vector<SmoothCase> cases{
      {stillSphere(), 12.0, still, 2.0, 0.8, long_s},
      {stillSinusoid(), 18.0, still, 2.0, 0.8, long_s},
      {movingSphere(40), 9.0, moving, 3.0, 1.0, quick ? 4.0 : 12.0},
      {syntheticScene(server::SceneKind::kApproach), 8.0, moving, 5.0, 2.0},
      {syntheticScene(server::SceneKind::kTumble), 6.0, moving, 5.0, 2.0}};
  if (!quick) {
    cases.push_back({stillEllipsoid(), 10.0, still, 2.0, 0.8, long_s});
    cases.push_back({movingSphere(2), 9.0, moving, 3.0, 1.0});
    cases.push_back({movingSphere(10), 9.0, moving, 3.0, 1.0});
    cases.push_back({spinningEllipsoid(), 10.0, moving, 5.0, 2.0});
  }
  std::vector<Case> out;
  out.reserve(cases.size());
  for (const SmoothCase& what : cases) out.emplace_back([=] { return measure(what, quick); });
  return out;
}

}  // namespace hapticast::evaluate
