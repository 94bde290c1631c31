// SPDX-License-Identifier: MIT
// Eq. 6: F = beta m_object a_object - m_cursor a_cursor, plus impact pulses. Real-time room.
#pragma once

#include <cstdint>

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/playback/scene.hpp"
#include "client/haptics/stream_timing.hpp"

namespace hapticast::client {

inline constexpr double kCursorMass_kg = 0.045;

class DynamicForce {
 public:
  explicit DynamicForce(const DeviceProfile& profile) noexcept;

  /// Force in N, device frame. `scale`: nominal -> device mm (beta, together with mm -> m). The
  /// acceleration of the object is taken at the contact point (centre + rotation), a_cursor in
  /// device m/s². The weight min(1, d/0.2 mm) of the penetration is applied here. Zero without
  /// contact, when not finite. `contact_mm`: the contact in nominal mm, where rotation
  /// and grid are evaluated; without it the object's reference point stands for all of it. The
  /// object's share is at most half of the device's peak, all of it at most the peak. An impact
  /// pushes along its change of velocity: a half-sine of 15 ms from the impact's time on. The
  /// object's acceleration, turn, grid and impact count as far as its belief goes.
  Vec3 evaluate(const InterpolatedObject* object, double penetration_mm,
                const Vec3& cursor_acceleration_m_s2, MediaTime play_time,
                const StreamTiming& stream, double scale,
                const Vec3* contact_mm = nullptr) noexcept;

  /// The last evaluate() cut what the stream's own frames do not bear out, by more than is felt.
  [[nodiscard]] bool implausible() const noexcept { return implausible_; }

  /// The share of -m_cursor a_cursor in the force of the last evaluate(): the viewer's own, not the
  /// stream's.
  [[nodiscard]] const Vec3& inertia_N() const noexcept { return inertia_N_; }

  /// m_object = min(author's (0.5 kg when none is given), 5 kg, the device's continuous force /
  /// largest a), never below 10 m_cursor unless that force forces it. Always finite, >= 0.
  [[nodiscard]] double objectMass_kg(const StreamTiming& stream, double scale) const noexcept;

 private:
  [[nodiscard]] double cursorMass_kg() const noexcept;
  [[nodiscard]] Vec3 pulse_N(const InterpolatedObject& object, MediaTime play_time,
                             double kg_m_per_mm) noexcept;

  const DeviceProfile& profile_;
  // The impact whose pulse is or was last under way: frames that no longer list it do not cut it
  // off, and frames that put it a little later do not render it twice.
  bool has_pulse_ = false;
  Impact pulse_;
  std::uint32_t pulse_object_ = 0;
  bool implausible_pulse_ = false;
  bool implausible_ = false;
  Vec3 inertia_N_ = Vec3::Zero();
};

}  // namespace hapticast::client
