// SPDX-License-Identifier: MIT
// Side walls and rims: a push from the side has to be answered sideways, a press from above
// upwards.
#include <algorithm>
#include <cmath>

#include "tests/evaluate/accuracy/accuracy_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kMmPerPx = 0.25;

struct Pushed {
  double sideways = 0.0;  ///< rms error of the sideways displacement, share of the push
  double upward = 0.0;    ///< largest, share of the push
};

Pushed pushed(const std::vector<Tick>& ticks, double push_mm) {
  Pushed out;
  double square = 0;
  double count = 0;
  for (const Tick& tick : ticks) {
    if (tick.hand.truth_mm.norm() < 0.999 * push_mm) continue;  // on its way in or out
    square += tick.error_mm().head<2>().squaredNorm();
    out.upward = std::max(out.upward, std::abs(tick.displacement_mm.z()) / push_mm);
    count += 1;
  }
  out.sideways = std::sqrt(square / std::max(1.0, count)) / push_mm;
  return out;
}

void measurePush(const Wall& wall, const Streams& streams, bool own_mask, Outcome& out) {
  const std::string name = wall.scene.name + (own_mask ? ", own mask" : "");
  Goal sideways{"push 2 mm into the " + name + ": sideways force off by", "%", 4.0, 2.0};
  Goal upward{"push 2 mm into the " + name + ": upward force, of the push", "%", 1.0, 0.0};
  Goal edge{"push 0.5 mm into the " + name + ": off by, of the mask's edge", "px", 0.15, 0.1};
  std::vector<Variant> variants = allVariants();
  if (own_mask) variants = {defaultVariant(), thesisVariant()};
  const auto all_deep = renderTraces(streams, variants, pushingHand(wall, 2.0), pushTimes(wall));
  const auto all_slight = renderTraces(streams, variants, pushingHand(wall, 0.5), pushTimes(wall));
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const Variant& variant = variants[i];
    const ForceTrace& deep = all_deep[i];
    const ForceTrace& slight = all_slight[i];
    const Pushed two = pushed(deep.ticks, 2.0);
    const Pushed half = pushed(slight.ticks, 0.5);
    const double edge_px = 0.5 * half.sideways / kMmPerPx;
    out.rows.push_back(rowOf(name, "push 2 mm, sideways off by", variant, 100.0 * two.sideways, "%",
                             deep.tick_us));
    out.rows.push_back(
        rowOf(name, "push 2 mm, upward", variant, 100.0 * two.upward, "%", deep.tick_us));
    out.rows.push_back(rowOf(name, "push 0.5 mm, off by", variant, edge_px, "px", 0.0));
    const auto put = [&](double Goal::*which) {
      sideways.*which = 100.0 * two.sideways;
      upward.*which = 100.0 * two.upward;
      edge.*which = edge_px;
    };
    if (variant.is_default) put(&Goal::got);
    if (variant.is_thesis) put(&Goal::thesis);
    if (own_mask)
      out.rows.push_back(rowOf(wall.scene.name, "own mask off by", variant,
                               streams.of(variant.method).mask_error_px, "px", 0.0));
  }
  if (!own_mask) out.goals = {sideways, upward, edge};
}

// Sideways share of the force, most of it, while the hand presses inside the rim.
double sidewaysOf(const std::vector<Tick>& ticks) {
  double most = 0;
  for (const Tick& tick : ticks) {
    if (!tick.trulyTouches()) continue;
    const double length = tick.hand.truth_mm.norm();
    if (length > 0.3) most = std::max(most, tick.error_mm().head<2>().norm() / length);
  }
  return most;
}

// Outward force beyond what the surface explains as the hand leaves, of the force that was there.
double kickOf(const std::vector<Tick>& ticks, const Vec2& outward) {
  double kick = 0;
  for (const Tick& tick : ticks) kick = std::max(kick, tick.error_mm().head<2>().dot(outward));
  return kick;  // 1 mm deep
}

void measureRim(const Wall& wall, const Streams& streams, Outcome& out) {
  const std::string name = wall.scene.name;
  Goal press{"press 0.5 mm inside the rim of the " + name + ": sideways force", "%", 2.0, 0.0};
  Goal leave{"leave over the rim of the " + name + ": kick", "%", 1.0, 0.1};
  const Hand hand = rimHand(wall, 0.5);
  const std::vector<Variant> variants = allVariants();
  const auto all_pressed = renderTraces(streams, variants, hand, rimPressTimes());
  const auto all_left = renderTraces(streams, variants, hand, rimLeaveTimes());
  for (std::size_t i = 0; i < variants.size(); ++i) {
    const Variant& variant = variants[i];
    const ForceTrace& pressed = all_pressed[i];
    const ForceTrace& left = all_left[i];
    const double sideways = 100.0 * sidewaysOf(pressed.ticks);
    const double kick = 100.0 * kickOf(left.ticks, wall.at(0.0).outward);
    out.rows.push_back(rowOf(name, "press inside a rim, sideways", variant, sideways, "%", 0.0));
    out.rows.push_back(rowOf(name, "leave over a rim, kick", variant, kick, "%", 0.0));
    if (variant.is_default) press.got = sideways, leave.got = kick;
    if (variant.is_thesis) press.thesis = sideways, leave.thesis = kick;
  }
  out.goals.push_back(press);
  out.goals.push_back(leave);
}

Outcome measure(const Wall& wall, bool push, bool rim, bool quick) {
  Outcome out;
  const Streams exact = makeStreams(wall.scene);
  if (push) measurePush(wall, exact, false, out);
  if (rim) measureRim(wall, exact, out);
  if (!push || quick) return out;
  StreamKind segmented;
  segmented.seen.give_mask = false;
  measurePush(wall, makeStreams(wall.scene, segmented), true, out);
  return out;
}

}  // namespace

std::vector<Case> wallCases(bool quick) {
  std::vector<Case> out;
  out.emplace_back([=] { return measure(boxWall(), true, true, quick); });
  out.emplace_back([=] { return measure(stepWall(), true, true, quick); });
  if (quick) return out;
  out.emplace_back([=] { return measure(cylinderWall(), true, false, quick); });
  out.emplace_back([=] { return measure(boxWall(0.5), false, true, quick); });
  return out;
}

}  // namespace hapticast::evaluate
