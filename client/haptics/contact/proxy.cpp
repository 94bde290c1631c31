// SPDX-License-Identifier: MIT
// The tick of the proxy and its result. Free motion is in proxy_free_motion.cpp, motion in contact
// in proxy_contact_motion.cpp.
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

void Proxy::restart(bool faded) noexcept {
  *this = Proxy();
  faded_ = faded;
}

bool Proxy::clear(const MovingRelief& relief, const Vec3& hip_mm) noexcept {
  if (!valid_ || kind_ != Kind::kFree) return false;
  if (std::min(at_mm_.z(), hip_mm.z()) <= relief.highest_mm() &&
      !relief.aside(at_mm_.head<2>(), hip_mm.head<2>())) {
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
  if (point_mm.z() > probe_.relief().highest_mm() || !probe_.masked(point_mm.head<2>()))
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

Vec3 Proxy::normalHere() noexcept {
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
  ProxyTouch touch{.contact = true, .normal = normalHere()};
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

}  // namespace hapticast::client
