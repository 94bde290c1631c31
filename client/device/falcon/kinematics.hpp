// SPDX-License-Identifier: MIT
// Kinematics and statics of the Falcon: a delta robot with three translations. Metres, radians,
// newtons. The axes are those of the device frame; the origin is the centre of the base. No heap.
// Thread: any (pure functions).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "common/geometry.hpp"

namespace hapticast::client {

/// Centre of the workspace: the origin of the device frame.
inline const Vec3 kFalconCentre_m{0.0, 0.0, 0.125};

/// Converts encoder counts to arm angles.
Vec3 falconAngles_rad(const std::array<int, 3>& encoders) noexcept;
/// Converts arm angles to encoder counts, without rounding.
Vec3 falconEncoders(const Vec3& angles_rad) noexcept;

/// Inverse kinematics (closed form): returns the arm angles for a grip position; nullopt out of
/// reach.
std::optional<Vec3> falconInverse_rad(const Vec3& position_m) noexcept;

/// Returns d angle / d position, one row for each arm; nullopt out of reach or at a singularity.
std::optional<Eigen::Matrix3d> falconJacobian_rad_m(const Vec3& position_m) noexcept;

/// Forward kinematics by Newton's method from `start_m` (last position, or the centre). Returns the
/// grip position; nullopt without convergence.
std::optional<Vec3> falconForward_m(const Vec3& angles_rad, const Vec3& start_m) noexcept;

/// Returns the torques of the arms (N m) that produce `force_N` at the grip; nullopt as for the
/// Jacobian.
std::optional<Vec3> falconTorques(const Vec3& position_m, const Vec3& force_N) noexcept;

/// Returns the motor counts for the torques: -gain (counts/(N m)) times each. If one exceeds
/// `most`, all are scaled alike, so that the force keeps its direction. Torques that are not finite
/// become zero.
std::array<int, 3> falconMotors(const Vec3& torques, double gain, int most) noexcept;

}  // namespace hapticast::client
