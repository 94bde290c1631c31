// SPDX-License-Identifier: MIT
// The point of a surface that the HIP is tied to: a god-object (Zilles, Salisbury 1995) on a
// relief, moved by the contact march of client/haptics/README.md. One object, in its own frame; all
// lengths nominal mm. Real-time room.
#pragma once

#include <cstdint>

#include "client/haptics/contact/height_sampler.hpp"

namespace hapticast::client {

/// Coulomb friction. Requires 0 <= sliding <= sticking; 0 is none.
struct Friction {
  double sticking = 0.0;
  double sliding = 0.0;
};

/// What a tick asks of it, in the object's frame.
struct ProxyTick {
  Vec3 hip_mm = Vec3::Zero();  ///< finite
  Friction friction;
  int samples = 0;      ///< heights to be read at most, and 5 more to end well (relief_probe.hpp)
  bool jumped = false;  ///< the pose of the object changed by more than its motion
  double deepest_mm = 0.0;  ///< after a jump: deeper there is no force
};

/// What the proxy says of a tick, in the object's frame.
struct ProxyTouch {
  bool contact = false;
  Vec3 displacement_mm = Vec3::Zero();      ///< from the HIP to where it should be
  Vec3 normal = Vec3::UnitZ();              ///< of the surface at the proxy, outwards
  Vec3 shape_velocity_mm_s = Vec3::Zero();  ///< of the change of shape at the proxy
};

/// Solid is where the edge distance is positive and z below the relief: the mask's edge is a wall,
/// there is no floor outside and no bottom. On a still surface no move of the proxy lengthens the
/// way to the HIP, so only the hand's own work is given back. A surface that rises, arrives or
/// jumps takes the proxy along; by more than kJump_mm in a tick its force begins where the last
/// tick's was and fades to the true one (40 ms); deeper than ProxyTick::deepest_mm after a jump the
/// object is silent until the HIP is out of it.
class Proxy {
 public:
  static constexpr double kJump_mm = 0.3;

  /// Starts at the next HIP; `faded`: what it then touches begins with no force.
  void restart(bool faded) noexcept;
  /// The samples kept of the relief no longer hold.
  void forgetSamples() noexcept { probe_.forget(); }
  /// Nothing to feel and nothing to compute this tick: the proxy simply follows.
  bool clear(const MovingRelief& relief, const Vec3& hip_mm) noexcept;
  ProxyTouch update(const MovingRelief& relief, const ProxyTick& tick) noexcept;

  /// Heights read in the last touch().
  [[nodiscard]] int samplesUsed() const noexcept { return probe_.used(); }
  /// Where it is, object's frame.
  [[nodiscard]] const Vec3& position_mm() const noexcept { return at_mm_; }

 private:
  enum class Kind : std::uint8_t { kFree, kTop, kWall, kEmbedded };
  using Height = ReliefProbe::Height;

  // proxy.cpp: the tick and its result
  [[nodiscard]] bool isSolid(const Vec3& point_mm) noexcept;
  void placeOn(const Vec2& q_mm, const Height& height) noexcept;
  ProxyTouch finish() noexcept;
  [[nodiscard]] Vec3 normalHere() noexcept;

  // proxy_flight.cpp: changes of the surface, in the air
  void resolvePenetration() noexcept;
  void resolveTop() noexcept;
  void resolveWall() noexcept;
  void resolveFree() noexcept;
  bool pushOut(int moves, double longest_mm) noexcept;
  void castRay() noexcept;
  void enter(Vec3 outside_mm, const Vec3& inside_mm) noexcept;
  void enterFromAbove(const Vec3& outside_mm, const Vec3& inside_mm) noexcept;

  // proxy_slide.cpp: in contact
  void slideOnTop() noexcept;
  bool detach(const Vec3& path_mm) noexcept;
  bool fallsOff(const Height& here, const Vec2& step_mm, Height& there) noexcept;
  void stepOnTop(const Height& here, const Vec2& step_mm) noexcept;
  void stepBack(const Height& here, const Vec2& step_mm, Height& there, Vec2& q_mm) noexcept;
  void applyFriction(const Height& here, Vec2 step_mm, double depth_mm) noexcept;
  void slideOnWall() noexcept;
  void stepOffWall(const Vec2& outwards) noexcept;
  void stepAlongWall(const Vec2& along_mm) noexcept;
  /// How much of a way of this length friction lets a proxy go that is pressed in by depth_mm.
  [[nodiscard]] double share(double length_mm, double depth_mm) noexcept;
  /// Takes the place if that does not lengthen the way to the HIP.
  bool accept(const Vec2& q_mm, const Height& height) noexcept;

  // The state.
  bool valid_ = false;
  bool faded_ = true;
  Kind kind_ = Kind::kFree;
  bool slipping_ = false;
  int rested_ticks_ = 0;  // without a move
  Vec3 at_mm_ = Vec3::Zero();
  Vec3 offset_mm_ = Vec3::Zero();
  Vec3 displacement_mm_ = Vec3::Zero();
  ReliefProbe probe_;

  // Of this tick.
  Vec3 hip_mm_ = Vec3::Zero();
  Friction friction_;
  double deepest_mm_ = 0.0;
  bool jumped_ = false;
  bool moved_ = false;
  bool done_ = false;
};

}  // namespace hapticast::client
