// SPDX-License-Identifier: MIT
// Eq. 6: F = beta m_object a_object - m_cursor a_cursor, plus impact pulses. Real-time room.
#pragma once

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/lookup.hpp"

namespace hapticast::client {

inline constexpr double kCursorMass_kg = 0.045;

class DynamicForce {
 public:
  explicit DynamicForce(const DeviceProfile& profile) noexcept;

  /// Force in N, device frame. `scale`: nominal -> device mm (beta, together with mm -> m). The
  /// acceleration of the object is taken at the contact point (centre + rotation), a_cursor in
  /// device m/s². The weight min(1, d/0.2 mm) of the penetration is applied here. Zero without
  /// contact, when paused, when not finite.
  Vec3 evaluate(const ObjectNow* object, double penetration_mm,
                const Vec3& cursor_acceleration_m_s2, MediaTime play_time, const Controls& controls,
                double scale) noexcept;

  /// m_object = min(author's, device's share of force / largest a), never below 10 m_cursor unless
  /// the device's peak forces it.
  [[nodiscard]] double objectMass_kg(const Controls& controls, double scale) const noexcept;

 private:
  const DeviceProfile& profile_;
};

}  // namespace hapticast::client
