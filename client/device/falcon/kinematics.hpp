// SPDX-License-Identifier: MIT
// Where the Falcon's grip is and how its three arms push it: a delta robot with three
// translations. Metres, radians, newtons; the frame is the device's (x right, y up, z towards the
// user), its origin in the middle of the base. Pure and without heap. Thread: any.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "common/geometry.hpp"

namespace hapticast::client {

/// The middle of the workspace, which is the origin of the device frame.
inline const Vec3 kFalconCentre_m{0.0, 0.0, 0.125};

/// Angles of the arms at these encoder counts.
Vec3 falconAngles_rad(const std::array<int, 3>& encoders) noexcept;
/// The counts of these angles, not rounded.
Vec3 falconEncoders(const Vec3& angles_rad) noexcept;

/// The arms' angles where the grip is here; closed form. None: out of reach.
std::optional<Vec3> falconInverse_rad(const Vec3& position_m) noexcept;

/// d angle / d position, a row an arm. None: out of reach or singular.
std::optional<Eigen::Matrix3d> falconJacobian_rad_m(const Vec3& position_m) noexcept;

/// Where the grip is with these angles, by Newton steps from `start_m` (the last pose, or the
/// centre). None: it did not get there.
std::optional<Vec3> falconForward_m(const Vec3& angles_rad, const Vec3& start_m) noexcept;

/// Torques of the arms (N m) that make this force at the grip. None as for the Jacobian.
std::optional<Vec3> falconTorques(const Vec3& position_m, const Vec3& force_N) noexcept;

/// What the motors are sent for these torques: -gain (counts per N m) each, all scaled alike where
/// one would be beyond `most`, so that the force keeps its direction. Numbers that are not finite
/// are no torque.
std::array<int, 3> falconMotors(const Vec3& torques, double gain, int most) noexcept;

}  // namespace hapticast::client
