// SPDX-License-Identifier: MIT
// The tick of the proxy, its result, and free motion. Motion in contact is in
// proxy_contact_motion.cpp.
#include "client/haptics/contact/proxy.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::client {

namespace {

// Ticks at rest after which a slipping proxy sticks again. A slow hand on a wall whose normal
// varies by a degree or two rests for single ticks. Sticking in each of them would cause a
// saw-tooth force.
constexpr int kStuck_ticks = 20;
constexpr int kPhases = 64;           // of a tick; a phase reads a height, or at most two follow
constexpr double kFade = 1.0 / 40.0;  // share of the offset that each tick removes
constexpr double kForgotten_mm = 1e-6;

}  // namespace

bool Proxy::continueOn(const MovingRelief& relief, double c, double s,
                       const Vec3& shift_mm) noexcept {
  if (kind_ != Kind::kTop && kind_ != Kind::kWall) return false;
  const Vec3 at_mm = rotate(at_mm_, c, s) + shift_mm;
  const Vec2 q_mm = at_mm.head<2>();
  const double edge_mm = relief.now(relief.edges(q_mm)).distance_mm;
  const double apart_mm = kind_ == Kind::kWall
                              ? std::abs(edge_mm)
                              : std::abs(relief.now(relief.heights(q_mm)).height_mm - at_mm.z());
  if (!(apart_mm <= kJump_mm) || (kind_ == Kind::kTop && edge_mm <= 0.0)) return false;
  at_mm_ = at_mm;
  offset_mm_ = rotate(offset_mm_, c, s);
  displacement_mm_ = rotate(displacement_mm_, c, s);
  probe_.forget();
  return true;
}

bool Proxy::clear(const MovingRelief& relief, const Vec3& hip_mm) noexcept {
  if (!valid_ || kind_ != Kind::kFree) return false;
  if (std::min(at_mm_.z(), hip_mm.z()) <= relief.highest_mm() &&
      !relief.isAside(at_mm_.head<2>(), hip_mm.head<2>())) {
    return false;
  }
  at_mm_ = hip_mm;
  probe_.begin(relief, 0);
  return true;
}

ProxyTouch Proxy::update(const MovingRelief& relief, const ProxyTick& tick) noexcept {
  probe_.begin(relief, tick.samples);
  hip_mm_ = tick.hip_mm;
  friction_ = tick.friction;
  deepest_mm_ = tick.deepest_mm;
  jumped_ = tick.jumped;
  moved_ = done_ = false;
  // After a jump the HIP has not moved through the air. The depth after the jump decides again.
  if (jumped_ && kind_ == Kind::kEmbedded) kind_ = Kind::kFree;
  if (!valid_ || (jumped_ && kind_ == Kind::kFree)) at_mm_ = hip_mm_;
  valid_ = true;
  resolvePenetration();
  for (int phase = 0; phase < kPhases && probe_.left() > 0 && !done_; ++phase) {
    switch (kind_) {
      case Kind::kFree:
        castRay();
        break;
      case Kind::kTop:
        slideOnTop();
        break;
      case Kind::kWall:
        slideOnWall();
        break;
      case Kind::kEmbedded:
        done_ = true;
        break;
    }
  }
  // The samples ran out before a contact: the proxy follows the HIP.
  if (kind_ == Kind::kFree && !done_ && !isSolid(hip_mm_)) at_mm_ = hip_mm_;
  return finish();
}

// --- Samples and places.

bool Proxy::isSolid(const Vec3& point_mm) noexcept {
  if (point_mm.z() > probe_.relief().highest_mm() || !probe_.isMasked(point_mm.head<2>()))
    return false;
  const Vec2 q_mm = point_mm.head<2>();
  const Height height = probe_.height(q_mm);
  if (kind_ == Kind::kFree) probe_.keep(q_mm, height);
  return point_mm.z() < height.now.height_mm;
}

void Proxy::placeOn(const Vec2& q_mm, const Height& height) noexcept {
  kind_ = Kind::kTop;
  at_mm_ = {q_mm.x(), q_mm.y(), height.now.height_mm};
  probe_.keep(q_mm, height);
}

// --- Result of the tick.

Vec3 Proxy::computeNormal() noexcept {
  if (kind_ == Kind::kWall) {
    const Vec2 outwards = -probe_.edge(at_mm_.head<2>()).gradient;
    const double length = outwards.norm();
    return length > 0.0 ? Vec3(outwards.x() / length, outwards.y() / length, 0.0)
                        : Vec3(Vec3::UnitZ());
  }
  const Vec2 gradient = probe_.height(at_mm_.head<2>()).now.gradient;
  return Vec3(-gradient.x(), -gradient.y(), 1.0) / std::sqrt(1.0 + gradient.squaredNorm());
}

ProxyTouch Proxy::finish() noexcept {
  rested_ticks_ = moved_ ? 0 : std::min(rested_ticks_ + 1, kStuck_ticks);
  if (rested_ticks_ >= kStuck_ticks) slipping_ = false;
  const Vec3 path_mm = at_mm_ - hip_mm_;
  if (jumped_ && path_mm.squaredNorm() > deepest_mm_ * deepest_mm_) kind_ = Kind::kEmbedded;
  const bool faded = faded_;
  faded_ = true;
  if (kind_ == Kind::kFree || kind_ == Kind::kEmbedded) {
    offset_mm_ = displacement_mm_ = Vec3::Zero();
    return {};
  }
  if (jumped_ && faded) {
    offset_mm_ = path_mm - displacement_mm_;
  } else {
    offset_mm_ *= 1.0 - kFade;
  }
  if (offset_mm_.squaredNorm() < kForgotten_mm * kForgotten_mm) offset_mm_ = Vec3::Zero();
  ProxyTouch touch{.contact = true, .normal = computeNormal()};
  // The hand retreats faster than the offset fades: shorten the offset, so that the force does not
  // pull.
  const double pull_mm = std::min(0.0, (path_mm - offset_mm_).dot(touch.normal));
  offset_mm_ += pull_mm * touch.normal;
  displacement_mm_ = touch.displacement_mm = path_mm - offset_mm_;
  touch.shape_velocity_mm_s =
      kind_ == Kind::kWall
          ? Vec3(touch.normal * probe_.edgeRate_mm_s())
          : Vec3(0.0, 0.0, probe_.relief().rate_mm_s(probe_.height(at_mm_.head<2>()).frames));
  return touch;
}

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
  if (!probe_.isMasked(q_mm)) {
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
    at_mm_.head<2>() += limitLength(stepToEdge(edge), longest_mm);
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
  if (probe_.isMasked(outside_mm.head<2>())) {
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
