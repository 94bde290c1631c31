// SPDX-License-Identifier: MIT
// God-object proxy (Zilles, Salisbury 1995) on a relief: the surface point that a spring ties to
// the HIP. A contact march moves the proxy (client/haptics/README.md, section 3). One object, in
// its own frame; lengths are nominal mm.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "client/haptics/contact/height_sampler.hpp"
#include "common/relief/height_field.hpp"

namespace hapticast::client {

/// Coefficients of Coulomb friction. Requires 0 <= sliding <= sticking; 0 is no friction.
struct Friction {
  double sticking = 0.0;
  double sliding = 0.0;
};

/// Input of a tick, in the object's frame.
struct ProxyTick {
  Vec3 hip_mm = Vec3::Zero();  ///< finite
  Friction friction;
  int samples = 0;      ///< budget of heights; a started move may read 5 more (height_sampler.hpp)
  bool jumped = false;  ///< the object's pose changed by more than its motion explains
  double deepest_mm = 0.0;  ///< arming depth: deeper than this after a jump, the object is disarmed
};

/// Result of a tick, in the object's frame.
struct ProxyTouch {
  bool contact = false;
  Vec3 displacement_mm = Vec3::Zero();  ///< from the HIP to the proxy, less the offset of a jump
  Vec3 normal = Vec3::UnitZ();          ///< unit normal of the surface at the proxy, outwards
  Vec3 shape_velocity_mm_s = Vec3::Zero();  ///< velocity of the change of shape at the proxy
};

/// The proxy of one object. *Solid* is the region with a positive edge distance and z below the
/// relief. So the edge of the mask is a wall; there is no floor outside the mask and no bottom.
///
/// On a surface at rest no move of the proxy increases its distance from the HIP, so the spring
/// returns only the hand's own work. A surface that rises, arrives or jumps moves the proxy with
/// it. A move by more than kJump_mm in a tick is a jump. After it the force begins at the force of
/// the last tick and fades to the true one (time constant 40 ms). If the distance from the HIP
/// exceeds ProxyTick::deepest_mm after a jump, the object is disarmed until the HIP is out of it.
class Proxy {
 public:
  /// Largest change of the surface in a tick that is no jump.
  static constexpr double kJump_mm = 0.3;

  /// Starts over at the next HIP. With `faded`, a contact at that HIP begins without a force.
  void restart(bool faded) noexcept;
  /// Invalidates the stored samples of the relief.
  void forgetSamples() noexcept { probe_.forget(); }
  /// Moves a free proxy to the HIP if no contact is possible in between. Returns false if the tick
  /// needs update().
  bool clear(const MovingRelief& relief, const Vec3& hip_mm) noexcept;
  /// Computes the contact of one tick.
  ProxyTouch update(const MovingRelief& relief, const ProxyTick& tick) noexcept;

  /// Heights read in the last update().
  [[nodiscard]] int samplesUsed() const noexcept { return probe_.used(); }
  /// Position of the proxy, object's frame.
  [[nodiscard]] const Vec3& position_mm() const noexcept { return at_mm_; }

 private:
  enum class Kind : std::uint8_t { kFree, kTop, kWall, kEmbedded };
  using Height = ReliefProbe::Height;

  // proxy.cpp: the tick and its result.
  [[nodiscard]] bool isSolid(const Vec3& point_mm) noexcept;
  void placeOn(const Vec2& q_mm, const Height& height) noexcept;
  ProxyTouch finish() noexcept;
  [[nodiscard]] Vec3 normalHere() noexcept;

  // proxy.cpp: reactions to changes of the surface, and free motion.
  void resolvePenetration() noexcept;
  void resolveTop() noexcept;
  void resolveWall() noexcept;
  void resolveFree() noexcept;
  bool pushOut(int moves, double longest_mm) noexcept;
  void castRay() noexcept;
  void enter(Vec3 outside_mm, const Vec3& inside_mm) noexcept;
  void enterFromAbove(const Vec3& outside_mm, const Vec3& inside_mm) noexcept;

  // proxy_contact_motion.cpp: motion in contact.
  void slideOnTop() noexcept;
  bool detach(const Vec3& path_mm) noexcept;
  bool fallsOff(const Height& here, const Vec2& step_mm, Height& there) noexcept;
  void stepOnTop(const Height& here, const Vec2& step_mm) noexcept;
  void stepBack(const Height& here, const Vec2& step_mm, Height& there, Vec2& q_mm) noexcept;
  void applyFriction(const Height& here, Vec2 step_mm, double depth_mm) noexcept;
  void slideOnWall() noexcept;
  void stepOffWall(const Vec2& outwards) noexcept;
  void stepAlongWall(const Vec2& along_mm) noexcept;
  /// Share (0..1) of a move by `length_mm` that friction allows to a proxy with the penetration
  /// `depth_mm`. Updates slipping_.
  [[nodiscard]] double share(double length_mm, double depth_mm) noexcept;
  /// Moves the proxy to `q_mm` unless that increases the distance from the HIP. Returns true if the
  /// proxy moved.
  bool accept(const Vec2& q_mm, const Height& height) noexcept;

  // State across ticks.
  bool valid_ = false;
  bool faded_ = true;
  Kind kind_ = Kind::kFree;
  bool slipping_ = false;
  int rested_ticks_ = 0;  // ticks without a move, up to the limit for sticking
  Vec3 at_mm_ = Vec3::Zero();
  /// Offset of a jump: subtracted from the vector from HIP to proxy, decays to zero.
  Vec3 offset_mm_ = Vec3::Zero();
  /// Displacement of the last tick, with the offset.
  Vec3 displacement_mm_ = Vec3::Zero();
  ReliefProbe probe_;

  // State of this tick.
  Vec3 hip_mm_ = Vec3::Zero();
  Friction friction_;
  double deepest_mm_ = 0.0;
  bool jumped_ = false;
  bool moved_ = false;
  bool done_ = false;
};

// Steps that the free motion and the contact motion of the proxy share. For client/haptics/contact
// only.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).

constexpr double kLookAhead_px = 0.5;  // sub-step of a march: skips no feature of 1 px (prototype)
constexpr double kOutside_mm = 1e-3;   // distance of a proxy at a wall from the edge, outside

/// Returns `step_mm`, shortened to at most `longest_mm`.
inline Vec2 limited(const Vec2& step_mm, double longest_mm) noexcept {
  const double length_mm = step_mm.norm();
  return length_mm > longest_mm ? Vec2(step_mm * (longest_mm / length_mm)) : step_mm;
}

/// Returns the Newton step to the point kOutside_mm outside the edge.
inline Vec2 stepToEdge(const EdgeSample& edge) noexcept {
  return -edge.gradient *
         ((edge.distance_mm + kOutside_mm) / std::max(0.25, edge.gradient.squaredNorm()));
}

/// Bracketed secant method for a zero crossing. Invariant: the value is not positive at `low` and
/// positive at `high`.
struct Bracket {
  double low, low_value, high, high_value;

  /// Next argument to evaluate, within [low, high].
  [[nodiscard]] double secant() const noexcept {
    const double span = high_value - low_value;
    return span > 0.0 ? std::clamp(low - low_value * (high - low) / span, low, high) : high;
  }
  /// Replaces one end of the bracket by the value at `t`.
  void push(double t, double value) noexcept {
    (value > 0.0 ? high : low) = t;
    (value > 0.0 ? high_value : low_value) = value;
  }
};

}  // namespace hapticast::client
