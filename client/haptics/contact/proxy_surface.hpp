// SPDX-License-Identifier: MIT
// The surface model `proxy`. Each object and layer of the scene has a god-object proxy of its own.
// The model combines the displacements of all proxies into one displacement. So overlapping objects
// act like one spring, and their forces do not add up.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "client/haptics/contact/proxy.hpp"
#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/parameter_rate_limiter.hpp"

namespace hapticast::client {

/// Returns the friction coefficients of an author's material. They are finite, and 0 <= sliding <=
/// sticking <= 1.5. A NaN counts as no friction.
Friction toFriction(const Material& material) noexcept;

/// Computes the joint contact of the proxies of all objects.
class ProxySurface {
 public:
  /// Largest number of heights that the proxies read in a tick, summed over all objects near the
  /// HIP. A move that has begun may read 5 more. Edge samples do not count.
  ///
  /// Measured at a HIP speed of 10 cm/s: with this value, a proxy on a rough relief stops before
  /// its goal in 0.5 % of the ticks. On smooth reliefs it reaches its goal in every tick.
  static constexpr int kSamples = 24;

  /// Returns the contact of the HIP with all objects of `scene`, in nominal mm.
  ///
  /// The displacement is the shortest one that leads the HIP out of all objects. So displacements
  /// in the same direction do not add up, but displacements at right angles do. Normal and surface
  /// velocity are means over the contacts, weighted by the lengths of the displacements.
  /// Contact::object is the object with the longest displacement. Each pair of object id and layer
  /// has a proxy. The proxy is deleted when its object disappears.
  ///
  /// A surface or pose that changes by more than its motion explains is a jump. After such a jump
  /// this function fades in the displacement, so the caller need not handle it. An object that
  /// appears at the HIP begins with its full displacement, and so does a new epoch: Contact::jump
  /// is then set. An object that appears where another one vanished in the same tick continues the
  /// contact of that one, if the surface at the proxy is the same within Proxy::kJump_mm. A tracker
  /// that lost and found an object causes this: the object has a new id. If the displacement of an
  /// object is longer than `deepest_mm` after a jump, the object is disarmed until the HIP is out
  /// of it.
  Contact computeContact(const Scene& scene, const Vec3& hip_mm, const Workspace& workspace,
                         double deepest_mm) noexcept;

  /// Sets one friction coefficient for all objects. nullopt restores the author's coefficients. In
  /// contact the change is gradual (ParameterRateLimiter).
  void setFriction(const std::optional<double>& friction) noexcept { friction_ = friction; }
  /// Deletes the state of all proxies. Call it when the scene or the HIP does not continue that of
  /// the last tick. The contacts of the next tick begin at their full depth, so the caller must
  /// fade in the force.
  void restart() noexcept;

  /// Returns the number of heights that the last computeContact() has read.
  [[nodiscard]] int samplesUsed() const noexcept { return used_; }

 private:
  /// A proxy, and the state of its object in the last scene. A comparison with that state separates
  /// a jump from a motion.
  struct ProxySlot {
    std::uint64_t key = 0;
    std::uint64_t tick = 0;  // last tick with this object
    bool arrived = false;    // the proxy has not been updated yet since the object appeared
    MovingRelief relief;
    Proxy proxy;
    ProxyTouch touch;  // result of the last tick
    ParameterRateLimiter sticking;
    ParameterRateLimiter sliding;
    Vec3 position_mm = Vec3::Zero();
    Vec3 velocity_mm_s = Vec3::Zero();
    double angle_rad = 0.0;
    double angular_velocity_rad_s = 0.0;

    /// Deletes the contact. The next update of the proxy counts as an arrival of the object.
    void restart() noexcept;
    /// Stores the pose and the velocities of `object`.
    void setPose(const InterpolatedObject& object) noexcept;
  };
  /// An object near the HIP. Its proxy needs an update in this tick.
  struct Candidate {
    ProxySlot* tied = nullptr;
    const InterpolatedObject* object = nullptr;
    Vec3 hip_mm = Vec3::Zero();  // object's frame
    bool jumped = false;
  };

  [[nodiscard]] ProxySlot* isKnown(std::uint64_t key) noexcept;
  [[nodiscard]] ProxySlot& findUnused() noexcept;
  ProxySlot* findContinued(const InterpolatedObject& object, const Workspace& workspace) noexcept;
  static bool poseJumped(const ProxySlot& tied, const InterpolatedObject& object, double arm_mm,
                         double elapsed_s) noexcept;
  void gather(const Scene& scene, const Vec3& hip_mm, const Workspace& workspace) noexcept;
  Friction friction(ProxySlot& tied, const InterpolatedObject& object) const noexcept;
  void updateObject(ProxySlot& tied, const InterpolatedObject& object, const Vec3& hip_mm,
                    const Workspace& workspace, double elapsed_s) noexcept;

  std::array<ProxySlot, kMaxObjects> tied_;
  std::array<Candidate, kMaxObjects> near_;
  std::optional<double> friction_;  // coefficient of the user
  std::size_t near_count_ = 0;
  // Index of the first candidate; it changes each tick, because the sample budget may run out.
  std::size_t round_robin_ = 0;
  std::uint64_t tick_ = 1;
  MediaTime play_time_{};
  int used_ = 0;
};

}  // namespace hapticast::client
