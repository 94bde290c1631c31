// SPDX-License-Identifier: MIT
// Kinematics and statics of the Falcon, a delta robot with three translations. The units are
// metres, radians and newtons. The axes are those of the device frame. The origin is the centre of
// the robot's base. The functions use no heap.
// Thread: any (pure functions).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "common/geometry.hpp"

namespace hapticast::client {

/// Centre of the workspace, in the frame of the kinematics (origin at the Falcon's base). The
/// origin of the device frame lies here.
inline const Vec3 kFalconCentre_m{0.0, 0.0, 0.125};

/// Converts encoder counts to arm angles.
Vec3 falconAngles_rad(const std::array<int, 3>& encoders) noexcept;
/// Converts arm angles to encoder counts, without rounding.
Vec3 falconEncoders(const Vec3& angles_rad) noexcept;

/// Inverse kinematics in closed form. Returns the angles of the arms for a position of the grip.
/// Returns nullopt if the grip cannot reach the position.
std::optional<Vec3> falconInverse_rad(const Vec3& position_m) noexcept;

/// Returns the Jacobian d angle / d position at `position_m`, with one row for each arm. Returns
/// nullopt at a singularity, or if the grip cannot reach the position.
std::optional<Eigen::Matrix3d> falconJacobian_rad_m(const Vec3& position_m) noexcept;

/// Forward kinematics by Newton's method. Returns the position of the grip for the angles of the
/// arms. The iteration starts at `start_m`, which is the last position or the centre. Returns
/// nullopt if the method does not converge.
std::optional<Vec3> falconForward_m(const Vec3& angles_rad, const Vec3& start_m) noexcept;

/// Returns the torques of the arms (N m) that produce `force_N` at the grip. Returns nullopt at a
/// singularity, or if the grip cannot reach `position_m`.
std::optional<Vec3> falconTorques(const Vec3& position_m, const Vec3& force_N) noexcept;

/// Returns the motor counts for the torques: each is -gain times its torque, with the gain in
/// counts/(N m). If one count exceeds `most`, all counts are scaled by the same factor, so that the
/// force has the same direction. Torques that are not finite become zero.
std::array<int, 3> falconMotors(const Vec3& torques, double gain, int most) noexcept;

}  // namespace hapticast::client
