// SPDX-License-Identifier: MIT
// God-object proxy (Zilles, Salisbury 1995) on the relief of one object. The proxy is the surface
// point that a spring ties to the HIP. Outside the object the proxy equals the HIP. When the HIP
// enters the object, the proxy stays on the surface. There it slides towards the point nearest to
// the HIP, in small steps, as far as friction allows (client/haptics/README.md, section 3). All
// vectors are in the object's own frame, and lengths are nominal mm.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "client/haptics/contact/height_sampler.hpp"
#include "common/geometry.hpp"
#include "common/relief/height_field.hpp"

namespace hapticast::client {

/// Coefficients of Coulomb friction. Requires 0 <= sliding <= sticking; 0 is no friction.
struct Friction {
  double sticking = 0.0;
  double sliding = 0.0;
};

/// Input of one tick, in the object's frame.
struct ProxyTick {
  Vec3 hip_mm = Vec3::Zero();  ///< position of the HIP; must be finite
  Friction friction;
  /// Largest number of heights that update() may read. A move that has begun may read 5 more.
  int samples = 0;
  /// True: the object's pose changed by more than the stated velocity explains.
  bool jumped = false;
  /// Arming depth: if the HIP is deeper than this after a jump, the object is disarmed.
  double deepest_mm = 0.0;
};

/// Result of one tick, in the object's frame.
struct ProxyTouch {
  bool contact = false;
  /// Vector from the HIP to the proxy, minus the offset that fades after a jump (class Proxy).
  Vec3 displacement_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< unit normal of the surface at the proxy, outwards
  /// Velocity of the surface at the proxy due to its change of shape.
  Vec3 shape_velocity_mm_s = Vec3::Zero();
};

/// The proxy of one object. A point is solid if it lies inside the mask and below the relief. So
/// the edge of the mask is a wall. There is no floor outside the mask, and the solid has no lower
/// end.
///
/// On a surface at rest no move of the proxy increases its distance from the HIP. So the spring
/// returns only the work of the hand. A surface that rises, appears or jumps moves the proxy.
///
/// A move of the surface by more than kJump_mm in a tick is a jump. After a jump the displacement
/// begins with the value of the last tick. It fades to its true value with a time constant of 40
/// ms. If the HIP is then farther from the proxy than ProxyTick::deepest_mm, the object is
/// disarmed: it has no force until the HIP is out of it.
class Proxy {
 public:
  /// Largest move of the surface in a tick that does not count as a jump.
  static constexpr double kJump_mm = 0.3;

  /// Deletes the state. The next tick then places the proxy at the HIP. If that tick begins in
  /// contact, its displacement begins at its full length.
  void restart() noexcept { *this = Proxy(); }
  /// Moves a proxy in contact to another object: `relief`, in whose frame a vector has the
  /// coordinates R v + `shift_mm`. R is the rotation by the angle with the cosine `c` and the sine
  /// `s`. Returns false and changes nothing if the surface of `relief` at the proxy differs by more
  /// than kJump_mm, or if the proxy has no contact.
  bool continueOn(const MovingRelief& relief, double c, double s, const Vec3& shift_mm) noexcept;
  /// Invalidates the stored samples of the relief.
  void forgetSamples() noexcept { probe_.forget(); }
  /// If the proxy is free and no contact is possible on its path to the HIP, moves the proxy to the
  /// HIP and returns true. The tick then needs no update(). Otherwise changes nothing and returns
  /// false.
  bool clear(const MovingRelief& relief, const Vec3& hip_mm) noexcept;
  /// Moves the proxy by one tick and returns the contact. Reads at most tick.samples + 5 heights.
  ProxyTouch update(const MovingRelief& relief, const ProxyTick& tick) noexcept;

  /// Returns the number of heights that the last update() has read.
  [[nodiscard]] int samplesUsed() const noexcept { return probe_.used(); }
  /// Returns the position of the proxy in the object's frame.
  [[nodiscard]] const Vec3& position_mm() const noexcept { return at_mm_; }

 private:
  enum class Kind : std::uint8_t { kFree, kTop, kWall, kEmbedded };
  using Height = ReliefProbe::Height;

  // proxy.cpp: the tick and its result.
  [[nodiscard]] bool isSolid(const Vec3& point_mm) noexcept;
  void placeOn(const Vec2& q_mm, const Height& height) noexcept;
  ProxyTouch finish() noexcept;
  [[nodiscard]] Vec3 computeNormal() noexcept;

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
  /// Returns the share (0..1) of a move by `length_mm` that friction allows. The penetration of the
  /// proxy is `depth_mm`. Updates slipping_.
  [[nodiscard]] double share(double length_mm, double depth_mm) noexcept;
  /// Moves the proxy to `q_mm`, if that does not increase its distance from the HIP. Returns true
  /// if the proxy moved.
  bool accept(const Vec2& q_mm, const Height& height) noexcept;

  // State across ticks.
  bool valid_ = false;
  bool faded_ = false;  // a jump in the next tick fades in
  Kind kind_ = Kind::kFree;
  bool slipping_ = false;
  int rested_ticks_ = 0;  // number of ticks without a move, at most as many as sticking needs
  Vec3 at_mm_ = Vec3::Zero();
  /// Offset after a jump. It is subtracted from the vector from the HIP to the proxy, and fades to
  /// zero.
  Vec3 offset_mm_ = Vec3::Zero();
  /// Displacement of the last tick, after the subtraction of the offset.
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

// The rest of this file is for client/haptics/contact only. Thread: loop, real-time.
constexpr double kLookAhead_px = 0.5;  // length of a small step; it skips no detail of 1 px
// Distance of a proxy at a wall from the mask's edge, on the outside.
constexpr double kOutside_mm = 1e-3;

/// Returns `v`, rotated about z by the angle with the cosine `c` and the sine `s`.
inline Vec3 rotate(const Vec3& v, double c, double s) noexcept {
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

/// Returns a Newton step from the sampled point towards the point kOutside_mm outside the mask's
/// edge.
inline Vec2 stepToEdge(const EdgeSample& edge) noexcept {
  return -edge.gradient *
         ((edge.distance_mm + kOutside_mm) / std::max(0.25, edge.gradient.squaredNorm()));
}

/// Secant method for the zero of a function, within a bracket. The function is never positive at
/// `low`, and always positive at `high`.
struct Bracket {
  double low, low_value, high, high_value;

  /// Returns the next argument at which the caller has to evaluate the function, within [low,
  /// high].
  [[nodiscard]] double secant() const noexcept {
    const double span = high_value - low_value;
    return span > 0.0 ? std::clamp(low - low_value * (high - low) / span, low, high) : high;
  }
  /// Narrows the bracket to `t`, where the function has the value `value`. A positive value
  /// replaces the high end, any other value the low end.
  void push(double t, double value) noexcept {
    (value > 0.0 ? high : low) = t;
    (value > 0.0 ? high_value : low_value) = value;
  }
};

}  // namespace hapticast::client
