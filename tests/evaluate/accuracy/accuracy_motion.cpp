// SPDX-License-Identifier: MIT
// Contacts that are held while the surface moves, and what a frame's arrival does to the force.
#include <algorithm>
#include <cmath>

#include "tests/evaluate/accuracy/accuracy_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kSureDepth_mm = 0.1;  // less may be a matter of the relief's error

struct HeldCase {
  std::string name;
  TouchScene scene;
  Hand hand;
};

Outcome measureHeld(const HeldCase& what) {
  Outcome out;
  Goal goal{"held contact, " + what.name + ": ticks that lose it", "ticks", 0.0, 0.0};
  const std::vector<Variant> variants = allVariants();
  const std::vector<ForceTrace> all = renderTraces(makeStreams(what.scene), variants, what.hand);
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const Variant& variant = variants[i];
    const ForceTrace& trace = all[i];
    const auto lost = std::count_if(trace.ticks.begin(), trace.ticks.end(), [](const Tick& tick) {
      return tick.hand.truth_mm.norm() > kSureDepth_mm && !tick.contact;
    });
    out.rows.push_back(
        rowOf(what.name, "held contact, ticks lost", variant, double(lost), "ticks", 0.0));
    out.rows.push_back(rowOf(what.name, "force, held contact", variant,
                             100.0 * relativeError(trace.ticks), "%", trace.tick_us));
    if (variant.is_default) goal.got = double(lost);
    if (variant.is_thesis) goal.thesis = double(lost);
  }
  out.goals.push_back(goal);
  return out;
}

// The largest step of the error in a tick with a new frame.
double stepAtFrames_mN(const std::vector<Tick>& ticks) {
  double step_mm = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    if (ticks[i].new_frame && ticks[i].time_s > 1.0)  // the hand has come
      step_mm = std::max(step_mm, (ticks[i].error_mm() - ticks[i - 1].error_mm()).norm());
  }
  return 1e3 * kStiffness_N_mm * step_mm;
}

struct Arrival {
  const char* name;
  double arrival_s;
  bool required;
};

Outcome measureSteps(double px_per_frame) {
  Outcome out;
  const TouchScene scene = steadySphere(px_per_frame);
  const Hand hand = holdingHand(scene, {7.0, 2.0}, 1.0);
  const Streams streams = makeStreams(scene);
  const std::vector<Variant> variants = allVariants();
  for (const Arrival& arrival :
       {Arrival{"in time", -0.08, true}, Arrival{"10 ms after they are due", -0.03, true},
        Arrival{"10 ms after their own time", 0.01, false}}) {
    const std::string name = std::string("steady motion, frames ") + arrival.name;
    Goal goal{"force step at a frame, " + name, "mN", 2.0, 0.2};
    const PlayTimes times{0.4, scene.duration_s - 0.3, arrival.arrival_s};
    const std::vector<ForceTrace> all = renderTraces(streams, variants, hand, times);
    for (std::size_t i = 0; i < variants.size(); ++i) {
      const Variant& variant = variants[i];
      const double step_mN = stepAtFrames_mN(all[i].ticks);
      out.rows.push_back(
          rowOf(name, "force step at a frame", variant, step_mN, "mN", all[i].tick_us));
      if (variant.is_default) goal.got = step_mN;
      if (variant.is_thesis) goal.thesis = step_mN;
    }
    if (arrival.required) out.goals.push_back(goal);
  }
  return out;
}

}  // namespace

std::vector<Case> motionCases(bool quick) {
  const TouchScene ball = movingSphere(10);
  const TouchScene plate = swingingPlate();
  const TouchScene dome = breathingDome();
  std::vector<HeldCase> held{
      {"moving surface", ball, holdingHand(ball, {5.0, -3.0}, 1.0)},
      {"rising surface", plate, stillHand(plate, {2.0, 1.0, 7.0})},
      {"surface that rises to the hand", plate, stillHand(plate, {2.0, 1.0, 12.0})},
      {"deforming surface", dome, stillHand(dome, {1.37, -0.81, 16.0})}};
  std::vector<Case> out;
  out.reserve(held.size());
  for (const HeldCase& what : held) out.emplace_back([=] { return measureHeld(what); });
  if (!quick) out.emplace_back([] { return measureSteps(7.3); });
  return out;
}

}  // namespace hapticast::evaluate
