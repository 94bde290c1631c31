// SPDX-License-Identifier: MIT
// Dynamic force of the touched object (thesis, Eq. 6): F = beta m_object a_object - m_cursor
// a_cursor. beta is the scale from the nominal frame to the device frame. The second term is
// virtual inertia: the HIP behaves as if it had the mass m_cursor. An impact of the object adds a
// short pulse. client/haptics/README.md, section 2, states the limits of both masses.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>
#include <optional>

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/playback/playout.hpp"
#include "client/haptics/playback/scene.hpp"

namespace hapticast::client {

/// Upper bound of m_cursor. A device with a smaller mass lowers m_cursor to its own mass. The bound
/// is the mass of an Omni-class device.
inline constexpr double kCursorMass_kg = 0.045;

/// Computes the dynamic force of the touched object.
class DynamicForce {
 public:
  /// `profile` must outlive this object.
  explicit DynamicForce(const DeviceProfile& profile) noexcept;

  /// Returns the dynamic force of this tick in N, device frame. The force is zero if `object` is
  /// null, if there is no contact, or if the result is not finite.
  ///
  /// If `penetration_mm` is below 0.2 mm, the force is proportional to it.
  /// `cursor_acceleration_m_s2` is the acceleration of the HIP in device m/s². `scale` converts
  /// nominal mm to device mm. `contact_mm` (nominal) is the point where the object's rotation and
  /// motion grid are evaluated. If it is null, that point is the object's reference point.
  ///
  /// The object's part of the force is at most half of the device's peak, and the whole force is at
  /// most the peak. The half does not include the force of an impact. An impact pushes along its
  /// change of velocity, by a half-sine that begins in the first tick that knows the impact. It
  /// lasts 15 ms, or longer where its rise would exceed four fifths of the slew limit (at most 39
  /// ms on an Omni). Acceleration, rotation, motion grid and impact of the object count only up to
  /// their plausibility bounds.
  Vec3 evaluate(const InterpolatedObject* object, double penetration_mm,
                const Vec3& cursor_acceleration_m_s2, MediaTime play_time,
                const StreamTiming& stream, double scale,
                const Vec3* contact_mm = nullptr) noexcept;

  /// Returns true if the last evaluate() reduced the force by more than 0.03 N because of the
  /// plausibility bounds.
  [[nodiscard]] bool implausible() const noexcept { return implausible_; }

  /// Returns the part of the last result of evaluate() that is virtual inertia, N. The hand causes
  /// this part, and the stream does not.
  [[nodiscard]] const Vec3& inertia_N() const noexcept { return inertia_N_; }

  /// Sets a mass that replaces the author's one, kg; nullopt: none.
  void replaceMass(const std::optional<double>& mass_kg) noexcept { own_mass_kg_ = mass_kg; }
  /// Returns m_object in kg, finite and at least 0. It is that of replaceMass(), or else the
  /// author's mass of an object with `material`, or else the author's mass of the stream. It is 0.5
  /// kg if the author states none. It is at most 5 kg, and at least 10 times m_cursor. One further
  /// bound may lower it below that: the continuous force of the device, divided by the largest
  /// acceleration of the stream. `scale` converts that acceleration to device mm.
  [[nodiscard]] double objectMass_kg(const Material& material, const StreamTiming& stream,
                                     double scale) const noexcept;

 private:
  [[nodiscard]] double cursorMass_kg() const noexcept;
  [[nodiscard]] Vec3 pulse_N(const InterpolatedObject& object, MediaTime play_time,
                             double kg_m_per_mm) noexcept;
  void startPulse(const Impact& impact, const InterpolatedObject& object, MediaTime play_time,
                  double kg_m_per_mm) noexcept;
  [[nodiscard]] bool pulseActs(MediaTime play_time) const noexcept;

  /// The pulse of the latest impact. It continues in later frames that do not list the impact. A
  /// frame that states a slightly later time for the same impact causes no second pulse.
  struct Pulse {
    Impact impact;
    std::uint32_t object = 0;
    MediaTime begin{};
    double length_s = 0.0;
    Vec3 height_N = Vec3::Zero();
    bool implausible = false;
  };

  const DeviceProfile& profile_;
  std::optional<double> own_mass_kg_;
  bool has_pulse_ = false;
  Pulse pulse_;
  bool implausible_ = false;
  Vec3 inertia_N_ = Vec3::Zero();
};

}  // namespace hapticast::client
