// SPDX-License-Identifier: MIT
// The hands that touch the scenes: where they are, and the exact expected displacement.
#include "tests/evaluate/touch/touch_hands.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticast::evaluate {

namespace {

/// The tip `depth_mm` below a place of the surface, along its normal (above it where negative).
HandPoint below(const HeightAt& height_mm, const Vec2& at_mm, double time_s, double depth_mm) {
  const Vec2 slope = gradientOf(height_mm, at_mm, time_s);
  const Vec3 normal = Vec3(-slope.x(), -slope.y(), 1.0).normalized();
  const Vec3 surface(at_mm.x(), at_mm.y(), height_mm(at_mm, time_s));
  return {surface - depth_mm * normal, std::max(0.0, depth_mm) * normal};
}

constexpr double kSpeed_mm_s = 20.0;

/// From a to b at that speed, beginning at `start_s`.
double moved(double a, double b, double start_s, double time_s) {
  const double way = std::clamp(kSpeed_mm_s * (time_s - start_s), 0.0, std::abs(b - a));
  return a + (b > a ? way : -way);
}

constexpr double kStart_s = 0.4;
constexpr double kPushStart_s = 0.5;  // 3 mm beside the wall
constexpr double kAlong_s = 1.2;      // all the way in since a while
constexpr double kRimDepth_mm = 1.0;

}  // namespace

Hand slidingHand(const TouchScene& scene, double reach_mm) {
  const double side_mm = reach_mm / std::numbers::sqrt2;
  return [=](double t) {
    const Vec2 path(side_mm * std::sin(2.0 * std::numbers::pi * 0.21 * t),
                    side_mm * std::sin(2.0 * std::numbers::pi * 0.29 * t + 0.4));
    // In the air at kStart_s: nobody appears inside.
    const double depth_mm = 0.6 - 0.9 * std::cos(2.0 * std::numbers::pi * 0.37 * (t - kStart_s));
    return below(scene.height_mm, scene.motion(t).position_mm.head<2>() + path, t, depth_mm);
  };
}

Hand holdingHand(const TouchScene& scene, const Vec2& in_body_mm, double depth_mm) {
  return [=](double t) {
    const Motion motion = scene.motion(t);
    const Vec2 at_mm = motion.position_mm.head<2>() + turned(in_body_mm, motion.angle_rad);
    return below(scene.height_mm, at_mm, t, moved(-1.0, depth_mm, kStart_s, t));
  };
}

Hand stillHand(const TouchScene& scene, const Vec3& hip_mm) {
  return [=](double t) {
    const Vec3 hip_now_mm(hip_mm.x(), hip_mm.y(),
                          moved(hip_mm.z() + 15.0, hip_mm.z(), kStart_s, t));
    const double depth_mm = scene.height_mm(hip_mm.head<2>(), t) - hip_now_mm.z();
    return HandPoint{hip_now_mm, depth_mm > 0.0 ? Vec3(0, 0, depth_mm) : Vec3::Zero()};
  };
}

Hand pushingHand(const Wall& wall, double push_mm) {
  const double turn_s = kAlong_s + 2.0 * wall.reach_mm / kSpeed_mm_s;
  const double end_s = pushTimes(wall).to_s;
  return [=](double t) {
    const double in_mm =
        t < end_s ? moved(-3.0, push_mm, kPushStart_s, t) : moved(push_mm, -3.0, end_s, t);
    const double along_mm = t < turn_s ? moved(-wall.reach_mm, wall.reach_mm, kAlong_s, t)
                                       : moved(wall.reach_mm, -wall.reach_mm, turn_s, t);
    const Wall::Point point = wall.at(along_mm);
    const Vec2 at_mm = point.at_mm - in_mm * point.outward;
    const Vec2 out_mm = std::max(0.0, in_mm) * point.outward;
    return HandPoint{{at_mm.x(), at_mm.y(), wall.push_z_mm}, {out_mm.x(), out_mm.y(), 0.0}};
  };
}

PlayTimes pushTimes(const Wall& wall) {
  return {kPushStart_s, kAlong_s + 4.0 * wall.reach_mm / kSpeed_mm_s, -0.08};
}

Hand rimHand(const Wall& wall, double inside_mm) {
  return [=](double t) {
    const double in_mm = moved(inside_mm, -3.0, 1.5, t);
    const Wall::Point point = wall.at(0.0);
    const Vec2 at_mm = point.at_mm - in_mm * point.outward;
    HandPoint hand = below(wall.top_mm, at_mm, t, moved(-2.0, kRimDepth_mm, 0.5, t));
    if (in_mm >= 0.0) return hand;
    // The top's nearest point has gone over the edge: only the side can be touched, as long as
    // the tip itself is inside.
    const double beyond_mm = (hand.hip_mm.head<2>() - point.at_mm).dot(point.outward);
    const Vec2 out_mm = std::max(0.0, -beyond_mm) * point.outward;
    hand.truth_mm = Vec3(out_mm.x(), out_mm.y(), 0.0);
    return hand;
  };
}

PlayTimes rimPressTimes() { return {0.4, 1.5, -0.08}; }
PlayTimes rimLeaveTimes() { return {0.4, 2.0, -0.08}; }

}  // namespace hapticast::evaluate
