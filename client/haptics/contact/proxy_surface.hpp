// SPDX-License-Identifier: MIT
// The `proxy` surface model: one proxy for each object and layer of the scene, which share one
// stiffness where they push alike. Real-time room.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "client/haptics/contact/proxy.hpp"
#include "client/haptics/contact/surface_model.hpp"
#include "client/haptics/parameter_rate_limiter.hpp"

namespace hapticast::client {

/// Of an author's coefficients: finite, 0 <= sliding <= sticking <= 1.5; a NaN is none.
Friction toFriction(const Material& material) noexcept;

class ProxySurface {
 public:
  /// Heights read in a tick, all objects near the HIP together (and 5 more at most); samples of the
  /// edge are not counted. Measured: 24 leave 0.5 % of the ticks on a rough relief unfinished at
  /// 10 cm/s, none on smooth ones.
  static constexpr int kSamples = 24;

  /// The contact of the HIP with all objects: the shortest way out of all of them (two that overlap
  /// do not add up, walls across each other do); normal and surface velocity are the mean over the
  /// contacts, weighted by their displacements; `object` the one with the longest. Proxies are kept
  /// by object id and layer, and dropped with their object. A jump of the geometry (an object
  /// appears, its surface or pose changes by more than motion explains) never steps: its force
  /// fades in here, so Contact::jump says only that the epoch changed; deeper than `deepest_mm`
  /// (nominal) after a jump there is none until the HIP is out of the object.
  Contact computeContact(const Scene& scene, const Vec3& hip_mm, const Workspace& workspace,
                         double deepest_mm) noexcept;

  /// From now on everything has this friction, whatever its author says; none: the author's. Under
  /// the hand it changes slowly.
  void setFriction(const std::optional<double>& friction) noexcept { friction_ = friction; }
  /// The world or the HIP is not connected with the last tick's, and whoever says so fades the
  /// force: the next tick's contacts are told at their full depth.
  void restart() noexcept;

  [[nodiscard]] int samplesUsed() const noexcept { return used_; }

 private:
  /// A proxy and its object, as it was in the last scene: to tell a jump from a motion.
  struct ProxySlot {
    std::uint64_t key = 0;
    std::uint64_t tick = 0;  // when its object was last there
    MovingRelief relief;
    Proxy proxy;
    ProxyTouch touch;  // the last one
    ParameterRateLimiter sticking;
    ParameterRateLimiter sliding;
    Vec3 position_mm = Vec3::Zero();
    Vec3 velocity_mm_s = Vec3::Zero();
    double angle_rad = 0.0;
    double angular_velocity_rad_s = 0.0;
  };
  /// What has to be looked at this tick.
  struct Candidate {
    ProxySlot* tied = nullptr;
    const InterpolatedObject* object = nullptr;
    Vec3 hip_mm = Vec3::Zero();  // in the object's frame
    bool jumped = false;
  };

  [[nodiscard]] ProxySlot* isKnown(std::uint64_t key) noexcept;
  [[nodiscard]] ProxySlot& unused() noexcept;
  static bool poseJumped(const ProxySlot& tied, const InterpolatedObject& object, double arm_mm,
                         double elapsed_s) noexcept;
  void gather(const Scene& scene, const Vec3& hip_mm, const Workspace& workspace) noexcept;
  Friction friction(ProxySlot& tied, const InterpolatedObject& object) const noexcept;
  void updateObject(ProxySlot& tied, const InterpolatedObject& object, const Vec3& hip_mm,
                    const Workspace& workspace, double elapsed_s) noexcept;

  std::array<ProxySlot, kMaxObjects> tied_;
  std::array<Candidate, kMaxObjects> near_;
  std::optional<double> friction_;  // the user's
  std::size_t near_count_ = 0;
  std::size_t round_robin_ = 0;  // who comes first
  std::uint64_t tick_ = 1;
  bool just_restarted_ = true;
  MediaTime play_time_{};
  int used_ = 0;
};

}  // namespace hapticast::client
