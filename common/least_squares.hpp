// SPDX-License-Identifier: MIT
// Small linear least squares: normal equations by LDL^T decomposition, or the rectangular system by
// QR decomposition with column pivoting.
// In a translation unit of its own, because Eigen's decompositions cost 5 CPU seconds in every
// source that includes them (g++ -O3). Thread: any.
#pragma once

#include <Eigen/Core>

namespace hapticast {

/// Solves `normal` x = `right` for x by LDL^T. Requires a symmetric positive semidefinite matrix.
/// Returns non-finite numbers if there is no solution. Allocates nothing.
[[nodiscard]] Eigen::Vector3d solveNormal(const Eigen::Matrix3d& normal,
                                          const Eigen::Vector3d& right);
[[nodiscard]] Eigen::Vector4d solveNormal(const Eigen::Matrix4d& normal,
                                          const Eigen::Vector4d& right);
[[nodiscard]] Eigen::Matrix<double, 6, 1> solveNormal(const Eigen::Matrix<double, 6, 6>& normal,
                                                      const Eigen::Matrix<double, 6, 1>& right);

/// Returns the x with the least |`rows` x - `right`|. Requires as many rows as `right` has.
[[nodiscard]] Eigen::VectorXd solveLeastSquares(const Eigen::MatrixXd& rows,
                                                const Eigen::VectorXd& right);

}  // namespace hapticast
