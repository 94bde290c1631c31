// SPDX-License-Identifier: MIT
// Rendered friction: the ratio of the force along the surface to that across it, at breakaway
// and in slip, against the author's coefficients.
#include <algorithm>
#include <cmath>

#include "tests/evaluate/accuracy/accuracy_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kSticking = 0.5, kSliding = 0.3;
constexpr double kStart_s = 1.0;  // the hand, 1 mm deep, begins to move along
constexpr double kStuck_s = 0.2;  // within this time the surface lets go
constexpr double kSlipping_s = 0.45;
constexpr double kSlow_mm_s = 3.1;  // 0.6 % of the breakaway per tick

struct Rub {
  std::string name;
  TouchScene scene;
  Hand hand;
  std::function<Vec3(const Vec3& proxy_mm)> normal;  ///< outward, of the true surface
  bool required = true;
};

// Slowly until it has broken away.
double alongOf_mm(double time_s, double slip_mm_s) {
  return kSlow_mm_s * std::clamp(time_s - kStart_s, 0.0, kStuck_s) +
         slip_mm_s * std::max(0.0, time_s - kStart_s - kStuck_s);
}

// Along the normal from outside to 1 mm deep, then on along the surface.
Hand rubbingHand(const std::function<std::pair<Vec3, Vec3>(double along_mm)>& surface,
                 double slip_mm_s = 20.0) {
  return [=](double t) {
    const auto [at_mm, normal] = surface(alongOf_mm(t, slip_mm_s));
    const double depth_mm = std::min(1.0, -1.0 + 10.0 * (t - 0.5));
    return HandPoint{at_mm - depth_mm * normal, std::max(0.0, depth_mm) * normal};
  };
}

Rub plateRub() {
  const TouchScene scene = stillPlate();
  const Vec3 middle_mm = scene.motion(0.0).position_mm;
  const auto surface = [=](double along_mm) {
    return std::pair<Vec3, Vec3>{middle_mm + Vec3(along_mm - 4.0, 0.3 * along_mm, 0.0),
                                 Vec3::UnitZ()};
  };
  return {"plate", scene, rubbingHand(surface), [](const Vec3&) { return Vec3::UnitZ().eval(); }};
}

Rub sphereRub() {
  constexpr double kRadius_mm = 20.0;
  const TouchScene scene = stillSphere();
  const Vec3 centre_mm = scene.motion(0.0).position_mm;
  const auto surface = [=](double along_mm) {
    const double angle = (along_mm - 5.0) / kRadius_mm;
    const Vec3 normal = Vec3(std::sin(angle), 0.2, std::cos(angle)).normalized();
    return std::pair<Vec3, Vec3>{centre_mm + kRadius_mm * normal, normal};
  };
  return {"sphere", scene, rubbingHand(surface),
          [=](const Vec3& proxy_mm) { return (proxy_mm - centre_mm).normalized().eval(); }};
}

// `slow`: a mask's edge of whole pixels makes the normal waver, and that the finger stick again.
Rub wallRub(bool slow) {
  const Wall wall = boxWall();
  const auto surface = [=](double along_mm) {
    const Wall::Point point = wall.at(along_mm - 5.0);
    return std::pair<Vec3, Vec3>{{point.at_mm.x(), point.at_mm.y(), wall.push_z_mm},
                                 {point.outward.x(), point.outward.y(), 0.0}};
  };
  const Vec2 outward = wall.at(0.0).outward;
  Rub rub{"side wall", wall.scene, rubbingHand(surface),
          [=](const Vec3&) { return Vec3(outward.x(), outward.y(), 0.0); }};
  if (!slow) return rub;
  rub.name += ", 3 mm/s";
  rub.hand = rubbingHand(surface, kSlow_mm_s);
  rub.required = false;
  return rub;
}

double ratioOf(const Tick& tick, const Vec3& normal) {
  const double across = tick.displacement_mm.dot(normal);
  return across > 0.0 ? (tick.displacement_mm - across * normal).norm() / across : 0.0;
}

struct Rubbed {
  double breakaway = 0.0, slip = 0.0;  ///< off by, %
};

// `true_normal`: against the true surface, else against the rendered one (a mask's edge of
// whole pixels has directions that are a degree or two off).
Rubbed rubbed(const Rub& rub, const std::vector<Tick>& ticks, bool true_normal) {
  double breakaway = 0;
  double slip_square = 0;
  double count = 0;
  for (const Tick& tick : ticks) {
    const double since_s = tick.time_s - kStart_s;
    if (since_s < 0.0 || since_s > kSlipping_s) continue;
    const Vec3 proxy_mm = tick.hand.hip_mm + tick.displacement_mm;
    const double ratio = ratioOf(tick, true_normal ? rub.normal(proxy_mm) : tick.normal);
    if (since_s < kStuck_s) {
      breakaway = std::max(breakaway, ratio);
    } else {
      slip_square += std::pow(ratio / kSliding - 1.0, 2);
      count += 1;
    }
  }
  return {100.0 * std::abs(breakaway / kSticking - 1.0),
          100.0 * std::sqrt(slip_square / std::max(1.0, count))};
}

Outcome measure(const Rub& rub) {
  StreamKind kind;
  kind.longest_s = 2.0;
  kind.material.static_friction = kSticking;
  kind.material.dynamic_friction = kSliding;
  const Variant& variant = defaultVariant();
  const ForceTrace trace =
      renderTrace(makeStream(rub.scene, kind), variant, rub.hand, {0.4, 1.6, -0.08});
  Outcome out;
  for (const bool true_normal : {false, true}) {
    const Rubbed off = rubbed(rub, trace.ticks, true_normal);
    const std::string name = rub.name + (true_normal ? ", against the true normal" : "");
    out.rows.push_back(rowOf(name, "friction, breakaway off by", variant, off.breakaway, "%", 0.0));
    out.rows.push_back(rowOf(name, "friction, slip off by", variant, off.slip, "%", 0.0));
    if (true_normal || !rub.required) continue;
    out.goals.push_back(
        {"friction on the " + name + ": breakaway against mu", "%", 2.0, 1.0, off.breakaway});
    out.goals.push_back({"friction on the " + name + ": slip against mu", "%", 2.0, 1.0, off.slip});
  }
  return out;
}

}  // namespace

std::vector<Case> frictionCases(bool quick) {
  std::vector<Case> out;
  out.emplace_back([] { return measure(plateRub()); });
  if (quick) return out;
  out.emplace_back([] { return measure(sphereRub()); });
  out.emplace_back([] { return measure(wallRub(false)); });
  out.emplace_back([] { return measure(wallRub(true)); });
  return out;
}

}  // namespace hapticast::evaluate
