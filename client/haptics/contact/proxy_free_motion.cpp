// SPDX-License-Identifier: MIT
// The free proxy (contact march), and the reaction of the proxy to changes of the surface. The
// constants are from sweeps of the prototype (client/haptics/README.md, section 3).
#include <algorithm>
#include <cmath>

#include "client/haptics/contact/proxy.hpp"
#include "client/haptics/contact/proxy_steps.hpp"

namespace hapticast::client {

namespace {

constexpr int kReserve = 4;             // samples that a march leaves for the contact after it
constexpr double kFlatEdge = 0.25;      // a smaller gradient has no usable direction
constexpr double kLooseEdge_mm = 0.02;  // an edge farther away than this ends a wall contact
constexpr double kPush_mm = 0.5;        // longest push of a wall; at most kPushes in a tick
constexpr int kPushes = 3;
constexpr double kEntryError_mm = 0.05;

}  // namespace

// --- Changes of the surface since the last tick.

void Proxy::resolvePenetration() noexcept {
  switch (kind_) {
    case Kind::kFree:
      resolveFree();
      break;
    case Kind::kTop:
      resolveTop();
      break;
    case Kind::kWall:
      resolveWall();
      break;
    case Kind::kEmbedded:
      at_mm_ = hip_mm_;
      if (!isSolid(hip_mm_)) kind_ = Kind::kFree;
      break;
  }
}

void Proxy::resolveTop() noexcept {
  const Vec2 q_mm = at_mm_.head<2>();
  if (!probe_.masked(q_mm)) {
    kind_ = Kind::kFree;
    return;
  }
  const Height height = probe_.height(q_mm);
  const double rise_mm = height.now.height_mm - at_mm_.z();
  if (rise_mm < -kJump_mm) {
    kind_ = Kind::kFree;  // the surface fell: the march follows it
  } else if (rise_mm > deepest_mm_) {
    kind_ = Kind::kEmbedded;
  } else {
    jumped_ = jumped_ || rise_mm > kJump_mm;
    placeOn(q_mm, height);
  }
}

void Proxy::resolveWall() noexcept {
  const double inside_mm = probe_.edge(at_mm_.head<2>()).distance_mm;
  if (inside_mm < -kLooseEdge_mm) kind_ = Kind::kFree;
  if (inside_mm <= 0.0) return;
  const Vec3 before_mm = at_mm_;
  if (inside_mm > deepest_mm_ || !pushOut(kPushes, kPush_mm)) kind_ = Kind::kEmbedded;
  jumped_ = jumped_ || (at_mm_ - before_mm).norm() > kJump_mm;
}

/// The surface enclosed a free proxy: the proxy leaves by the shorter path.
void Proxy::resolveFree() noexcept {
  if (!isSolid(at_mm_)) return;
  const Vec2 q_mm = at_mm_.head<2>();
  const Height height = probe_.height(q_mm);
  const double up_mm =
      (height.now.height_mm - at_mm_.z()) / std::sqrt(1.0 + height.now.gradient.squaredNorm());
  const double aside_mm = probe_.edge(q_mm).distance_mm;
  if (aside_mm < up_mm && aside_mm < deepest_mm_) {
    const Vec3 before_mm = at_mm_;
    if (pushOut(kPushes, deepest_mm_)) {
      kind_ = Kind::kWall;
      jumped_ = jumped_ || aside_mm > kJump_mm;
      return;
    }
    at_mm_ = before_mm;
  }
  if (up_mm > deepest_mm_) {
    kind_ = Kind::kEmbedded;
    return;
  }
  placeOn(q_mm, height);
  jumped_ = jumped_ || up_mm > kJump_mm;
}

/// Moves the proxy by Newton steps to just outside the edge. Returns false if the gradient of the
/// distance is too small for a direction.
bool Proxy::pushOut(int moves, double longest_mm) noexcept {
  for (int i = 0; i < moves; ++i) {
    const EdgeSample edge = probe_.edge(at_mm_.head<2>());
    if (edge.distance_mm <= 0.0 && edge.distance_mm > -2.0 * kOutside_mm) break;
    at_mm_.head<2>() += limited(stepToEdge(edge), longest_mm);
  }
  const EdgeSample edge = probe_.edge(at_mm_.head<2>());
  return edge.distance_mm <= 0.0 || edge.gradient.squaredNorm() > kFlatEdge * kFlatEdge;
}

// --- Free motion.

/// Marches straight to the HIP and tests for the solid every half pixel.
void Proxy::castRay() noexcept {
  const Vec3 path_mm = hip_mm_ - at_mm_;
  const double steps =
      std::ceil(path_mm.head<2>().norm() / (kLookAhead_px * probe_.relief().pixel_mm()));
  const double most = std::max(1.0, double(probe_.left() - kReserve));
  const int count = steps > 1.0 ? static_cast<int>(std::min(steps, most)) : 1;  // 1 for NaN
  const Vec3 from_mm = at_mm_;
  Vec3 outside_mm = from_mm;
  for (int i = 1; i <= count; ++i) {
    const Vec3 here_mm = i == count ? hip_mm_ : Vec3(from_mm + path_mm * (double(i) / count));
    if (isSolid(here_mm)) {
      enter(outside_mm, here_mm);
      return;
    }
    outside_mm = here_mm;
  }
  at_mm_ = hip_mm_;
  done_ = true;
}

/// Finds the crossing between the two points, through the edge or through the relief.
void Proxy::enter(Vec3 outside_mm, const Vec3& inside_mm) noexcept {
  moved_ = true;
  if (probe_.masked(outside_mm.head<2>())) {
    enterFromAbove(outside_mm, inside_mm);
    return;
  }
  const Vec3 path_mm = inside_mm - outside_mm;
  Bracket edge{0.0, probe_.edge(outside_mm.head<2>()).distance_mm, 1.0,
               probe_.edge(inside_mm.head<2>()).distance_mm};
  Vec3 crossing_mm = inside_mm;
  for (int i = 0; i < 2; ++i) {
    const double t = edge.secant();
    crossing_mm = outside_mm + t * path_mm;
    edge.push(t, probe_.edge(crossing_mm.head<2>()).distance_mm);
  }
  if (crossing_mm.z() < probe_.height(crossing_mm.head<2>()).now.height_mm) {
    at_mm_ = crossing_mm;
    (void)pushOut(2, kPush_mm);
    kind_ = Kind::kWall;
    return;
  }
  enterFromAbove(crossing_mm, inside_mm);
}

void Proxy::enterFromAbove(const Vec3& outside_mm, const Vec3& inside_mm) noexcept {
  const Vec3 path_mm = inside_mm - outside_mm;
  const auto depthAt = [this](const Vec3& point_mm, Height& height) noexcept {
    height = probe_.height(point_mm.head<2>());
    return height.now.height_mm - point_mm.z();
  };
  Height height;
  const double outside_depth_mm = depthAt(outside_mm, height);
  const Height before = height;
  Bracket surface{0.0, outside_depth_mm, 1.0, depthAt(inside_mm, height)};
  Vec3 crossing_mm = inside_mm;
  double depth_mm = 0.0;
  for (int i = 0; i < 2; ++i) {
    const double t = surface.secant();
    crossing_mm = outside_mm + t * path_mm;
    depth_mm = depthAt(crossing_mm, height);
    surface.push(t, depth_mm);
  }
  if (depth_mm > kEntryError_mm) {
    placeOn(outside_mm.head<2>(), before);
  } else {
    placeOn(crossing_mm.head<2>(), height);
  }
}

}  // namespace hapticast::client
