// SPDX-License-Identifier: MIT
// Dynamic force (thesis, Eq. 6): F = beta m_object a_object - m_cursor a_cursor, plus the pulses of
// impacts. The second term is virtual inertia. client/haptics/README.md, section 2, states the
// limits of both masses.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/playback/playout.hpp"
#include "client/haptics/playback/scene.hpp"

namespace hapticast::client {

/// Upper bound of m_cursor; a lighter device lowers it. The default mass of an Omni-class device.
inline constexpr double kCursorMass_kg = 0.045;

/// Computes the dynamic force of the touched object.
class DynamicForce {
 public:
  /// `profile` must outlive this object.
  explicit DynamicForce(const DeviceProfile& profile) noexcept;

  /// Returns the dynamic force in N, device frame. Returns zero without an object or a contact, and
  /// if the result is not finite.
  ///
  /// `scale` converts nominal mm to device mm (beta, together with mm to m).
  /// `cursor_acceleration_m_s2` is in device m/s². `contact_mm` (nominal) is the point where
  /// rotation and grid are evaluated; null selects the object's reference point. The result
  /// includes the weight min(1, penetration / 0.2 mm).
  ///
  /// The object's share is at most half of the device's peak, the sum at most the peak. An impact
  /// pushes along its change of velocity: a half-sine of 15 ms that begins at the time of the
  /// impact. Acceleration, turn, grid and impact of the object count up to its plausibility bounds.
  Vec3 evaluate(const InterpolatedObject* object, double penetration_mm,
                const Vec3& cursor_acceleration_m_s2, MediaTime play_time,
                const StreamTiming& stream, double scale,
                const Vec3* contact_mm = nullptr) noexcept;

  /// Returns true if the last evaluate() removed a part beyond the plausibility bounds that exceeds
  /// 0.03 N.
  [[nodiscard]] bool implausible() const noexcept { return implausible_; }

  /// Share of -m_cursor a_cursor in the force of the last evaluate(), N. The hand causes this
  /// share, not the stream.
  [[nodiscard]] const Vec3& inertia_N() const noexcept { return inertia_N_; }

  /// Returns m_object in kg: the author's mass (0.5 kg without one), at most 5 kg, at least 10
  /// m_cursor. The device's continuous force / largest a bounds the result and may lower it below
  /// 10 m_cursor. Finite, >= 0.
  [[nodiscard]] double objectMass_kg(const StreamTiming& stream, double scale) const noexcept;

 private:
  [[nodiscard]] double cursorMass_kg() const noexcept;
  [[nodiscard]] Vec3 pulse_N(const InterpolatedObject& object, MediaTime play_time,
                             double kg_m_per_mm) noexcept;

  const DeviceProfile& profile_;
  // The latest impact with a pulse. A pulse continues in frames that no longer list its impact. A
  // frame that lists the impact a little later causes no second pulse.
  bool has_pulse_ = false;
  Impact pulse_;
  std::uint32_t pulse_object_ = 0;
  bool implausible_pulse_ = false;
  bool implausible_ = false;
  Vec3 inertia_N_ = Vec3::Zero();
};

}  // namespace hapticast::client
