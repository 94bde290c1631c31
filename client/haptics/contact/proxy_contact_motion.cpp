// SPDX-License-Identifier: MIT
// The proxy in contact: it slides on the relief and along the edge, with and without friction. The
// constants are from sweeps of the prototype (client/haptics/README.md, section 3).
#include <algorithm>
#include <array>
#include <cmath>

#include "client/haptics/contact/proxy.hpp"

namespace hapticast::client {

namespace {

constexpr double kStep_px = 1.0;  // longer steps tunnel through ridges of one pixel
constexpr double kConverged_mm = 2e-4;
constexpr double kLengthening_mm = 1e-4;  // tolerance for rounding
// A drop by more than kFall_mm plus kFallShare of the step ends the contact.
constexpr double kFall_mm = 0.01;
constexpr double kFallShare = 0.02;
constexpr double kOvershoot = 0.1;
constexpr double kBackEnough = 0.05;
constexpr int kBackSteps = 3;
constexpr double kUnderEdge_mm = 0.05;  // distance inside the edge where a wall's height is read
constexpr double kShrink = 0.35;
constexpr int kShrinks = 3;

/// A symmetric 2 x 2 matrix.
struct Metric {
  double xx, xy, yy;

  [[nodiscard]] double determinant() const noexcept { return xx * yy - xy * xy; }
  [[nodiscard]] Vec2 solve(const Vec2& b) const noexcept {
    return Vec2(yy * b.x() - xy * b.y(), xx * b.y() - xy * b.x()) / determinant();
  }
};

/// First fundamental form I + g gᵀ: lengths along the tangent plane.
Metric tangentPlane(const Vec2& g) noexcept {
  return {1.0 + g.x() * g.x(), g.x() * g.y(), 1.0 + g.y() * g.y()};
}

/// Adds only the curvature of a valley: the largest eigenvalue, if positive, along its vector.
Metric bendUpwards(Metric metric, const BlendedHeight& at, double depth_mm) noexcept {
  const double half = 0.5 * (at.bend_xx - at.bend_yy);
  const double root = std::sqrt(half * half + at.bend_xy * at.bend_xy);
  const double largest = 0.5 * (at.bend_xx + at.bend_yy) + root;
  if (!(largest > 0.0) || !(depth_mm > 0.0) || !(root > 0.0)) return metric;
  // v vᵀ = (1 + M) / 2, where M is the reflection with the axis v.
  const double weight = 0.5 * depth_mm * largest;
  metric.xx += weight * (1.0 + half / root);
  metric.xy += weight * at.bend_xy / root;
  metric.yy += weight * (1.0 - half / root);
  return metric;
}

/// Half the negative gradient of the squared distance from the HIP, over the relief.
Vec2 descent(const BlendedHeight& at, const Vec3& path_mm) noexcept {
  return path_mm.head<2>() + path_mm.z() * at.gradient;
}

/// Newton step to the point of the relief nearest to the HIP.
Vec2 newtonStep(const BlendedHeight& at, const Vec3& path_mm) noexcept {
  const Metric plane = tangentPlane(at.gradient);
  const double depth_mm = -path_mm.z();
  Metric metric = {plane.xx + depth_mm * at.bend_xx, plane.xy + depth_mm * at.bend_xy,
                   plane.yy + depth_mm * at.bend_yy};
  const double least = 0.25 * (1.0 + at.gradient.squaredNorm());
  if (metric.xx <= 0.0 || metric.determinant() < least) metric = bendUpwards(plane, at, depth_mm);
  return metric.solve(descent(at, path_mm));
}

double computeLengthOnPlane(const Vec2& step_mm, const Vec2& gradient) noexcept {
  const double rise_mm = gradient.dot(step_mm);
  return std::sqrt(step_mm.squaredNorm() + rise_mm * rise_mm);
}

}  // namespace

bool Proxy::accept(const Vec2& q_mm, const Height& height) noexcept {
  const Vec3 to_mm(q_mm.x(), q_mm.y(), height.now.height_mm);
  if ((hip_mm_ - to_mm).norm() > (hip_mm_ - at_mm_).norm() + kLengthening_mm) return false;
  placeOn(q_mm, height);
  moved_ = true;
  return true;
}

// --- On the relief.

void Proxy::slideOnTop() noexcept {
  const Height here = probe_.height(at_mm_.head<2>());
  const Vec3 path_mm = hip_mm_ - at_mm_;
  const Vec2& gradient = here.now.gradient;
  const double above_mm = path_mm.z() - gradient.dot(path_mm.head<2>());
  if (above_mm >= 0.0 && detach(path_mm)) return;
  if (friction_.sticking > 0.0) {
    const double depth_mm = -above_mm / std::sqrt(1.0 + gradient.squaredNorm());
    applyFriction(here, tangentPlane(gradient).solve(descent(here.now, path_mm)), depth_mm);
    return;
  }
  const Vec2 step_mm = newtonStep(here.now, path_mm);
  if (computeLengthOnPlane(step_mm, gradient) < kConverged_mm) {
    done_ = true;
    return;
  }
  stepOnTop(here, limitLength(step_mm, kStep_px * probe_.relief().pixel_mm()));
}

/// Leaves the relief towards the HIP if that path is free. Returns true if the proxy left.
bool Proxy::detach(const Vec3& path_mm) noexcept {
  const double look_mm = kLookAhead_px * probe_.relief().pixel_mm();
  const double length_mm = path_mm.head<2>().norm();
  const bool whole = length_mm <= look_mm;
  const Vec3 to_mm = whole ? hip_mm_ : Vec3(at_mm_ + path_mm * (look_mm / length_mm));
  if (isSolid(to_mm)) return false;
  at_mm_ = to_mm;
  kind_ = Kind::kFree;
  moved_ = true;
  done_ = whole;
  return true;
}

/// Frees the proxy if a step along the tangent plane leads over the rim, or to a drop of the
/// surface. Returns true in that case; otherwise `there` is the height at the end of the step.
bool Proxy::fallsOff(const Height& here, const Vec2& step_mm, Height& there) noexcept {
  const Vec2 q_mm = at_mm_.head<2>() + step_mm;
  const double tangent_mm = at_mm_.z() + here.now.gradient.dot(step_mm);
  if (probe_.isMasked(q_mm)) {
    there = probe_.height(q_mm);
    const double fall_mm = tangent_mm - there.now.height_mm;
    if (!(fall_mm > kFall_mm + kFallShare * step_mm.norm())) return false;
  }
  at_mm_ = {q_mm.x(), q_mm.y(), tangent_mm};
  kind_ = Kind::kFree;
  moved_ = true;
  return true;
}

void Proxy::stepOnTop(const Height& here, const Vec2& step_mm) noexcept {
  Height there;
  if (fallsOff(here, step_mm, there)) return;
  Vec2 q_mm = at_mm_.head<2>() + step_mm;
  stepBack(here, step_mm, there, q_mm);
  if (!accept(q_mm, there)) done_ = true;
}

/// Line search: if the whole step passes the nearest point along it, shortens the step to the
/// farthest place where the distance still descends.
void Proxy::stepBack(const Height& here, const Vec2& step_mm, Height& there, Vec2& q_mm) noexcept {
  const auto slope = [&](const Height& height, const Vec2& at) noexcept {
    const Vec3 path_mm = hip_mm_ - Vec3(at.x(), at.y(), height.now.height_mm);
    return descent(height.now, path_mm).dot(step_mm);
  };
  const double begin = slope(here, at_mm_.head<2>());
  double low = 0.0;
  double high = 1.0;
  double low_slope = begin;
  double high_slope = slope(there, q_mm);
  if (high_slope >= -kOvershoot * begin) return;
  for (int i = 0; i < kBackSteps; ++i) {
    const double part = std::clamp(low_slope / (low_slope - high_slope), 0.15, 0.75);
    const double t = low + part * (high - low);
    const Vec2 at = at_mm_.head<2>() + t * step_mm;
    const Height height = probe_.height(at);
    const double value = slope(height, at);
    // Use a point that still descends. Until one does, use the shortest of the others.
    if (value >= 0.0 || low == 0.0 || std::abs(value) < kBackEnough * begin) {
      there = height;
      q_mm = at;
    }
    if (std::abs(value) < kBackEnough * begin) return;
    (value >= 0.0 ? low : high) = t;
    (value >= 0.0 ? low_slope : high_slope) = value;
  }
}

// --- Friction.

double Proxy::share(double length_mm, double depth_mm) noexcept {
  const double mu = slipping_ ? friction_.sliding : friction_.sticking;
  if (length_mm < kConverged_mm || length_mm <= mu * depth_mm) return 0.0;
  slipping_ = true;
  return (length_mm - friction_.sliding * depth_mm) / length_mm;
}

/// Moves the proxy along the tangent plane as far as friction allows.
void Proxy::applyFriction(const Height& here, Vec2 step_mm, double depth_mm) noexcept {
  const Vec2 gradient = here.now.gradient;
  const double part = share(computeLengthOnPlane(step_mm, gradient), depth_mm);
  step_mm = limitLength(part * step_mm, kStep_px * probe_.relief().pixel_mm());
  done_ = true;
  if (computeLengthOnPlane(step_mm, gradient) < kConverged_mm) return;
  for (int i = 0; i <= kShrinks && done_; ++i, step_mm *= kShrink) {
    Height there;
    done_ = !fallsOff(here, step_mm, there) && !accept(at_mm_.head<2>() + step_mm, there);
  }
}

// --- Along the edge.

void Proxy::stepOffWall(const Vec2& outwards) noexcept {
  at_mm_.head<2>() += kOutside_mm * outwards;
  kind_ = Kind::kFree;
  moved_ = true;
}

void Proxy::slideOnWall() noexcept {
  const EdgeSample edge = probe_.edge(at_mm_.head<2>());
  const double steepness = edge.gradient.norm();
  if (!(steepness > 0.0)) {
    done_ = true;
    return;
  }
  const Vec2 outwards = -edge.gradient / steepness;
  const Vec3 path_mm = hip_mm_ - at_mm_;
  const double out_mm = outwards.dot(path_mm.head<2>());
  if (out_mm >= 0.0) {
    stepOffWall(outwards);
    return;
  }
  Vec2 along_mm = path_mm.head<2>() - out_mm * outwards;
  double rise_mm = path_mm.z();  // a wall does not hold the vertical direction
  double length_mm = std::sqrt(along_mm.squaredNorm() + rise_mm * rise_mm);
  if (friction_.sticking > 0.0) {
    const double part = share(length_mm, -out_mm);
    along_mm *= part;
    rise_mm *= part;
    length_mm *= part;
  }
  if (length_mm < kConverged_mm) {
    done_ = true;
    return;
  }
  const Vec2 under_mm = at_mm_.head<2>() - kUnderEdge_mm * outwards;
  const bool over_the_top = at_mm_.z() + rise_mm > probe_.height(under_mm).now.height_mm;
  at_mm_.z() += rise_mm;
  moved_ = true;
  if (over_the_top) {
    stepOffWall(outwards);
  } else {
    stepAlongWall(along_mm);
  }
}

/// Steps along the edge and by one Newton step back to it, unless that leads away from the HIP.
void Proxy::stepAlongWall(const Vec2& along_mm) noexcept {
  const Vec2 q_mm = at_mm_.head<2>();
  const Vec2 step_mm = limitLength(along_mm, kStep_px * probe_.relief().pixel_mm());
  const Vec2 beside_mm = q_mm + step_mm;
  const Vec2 to_mm = beside_mm + limitLength(stepToEdge(probe_.edge(beside_mm)), step_mm.norm());
  if ((hip_mm_.head<2>() - to_mm).norm() < (hip_mm_.head<2>() - q_mm).norm()) {
    at_mm_.head<2>() = to_mm;
  } else {
    done_ = true;
  }
}

}  // namespace hapticast::client
