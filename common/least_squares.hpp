// SPDX-License-Identifier: MIT
// Small linear least squares problems. LDL^T decomposition solves normal equations. QR
// decomposition with column pivoting solves rectangular systems.
//
// Eigen's decompositions cost 5 s of compilation in every source that includes them (g++ -O3). So
// they have a source of their own. Thread: any.
#pragma once

#include <Eigen/Core>

namespace hapticast {

/// Returns the solution x of `normal` x = `right`, by LDL^T decomposition. Requires a symmetric
/// positive semidefinite matrix. Returns non-finite numbers if there is no solution. Allocates
/// nothing.
[[nodiscard]] Eigen::Vector3d solveNormal(const Eigen::Matrix3d& normal,
                                          const Eigen::Vector3d& right);
[[nodiscard]] Eigen::Vector4d solveNormal(const Eigen::Matrix4d& normal,
                                          const Eigen::Vector4d& right);
[[nodiscard]] Eigen::Matrix<double, 6, 1> solveNormal(const Eigen::Matrix<double, 6, 6>& normal,
                                                      const Eigen::Matrix<double, 6, 1>& right);

/// Returns the vector x for which |`rows` x - `right`| is smallest. `rows` must have as many rows
/// as `right`.
[[nodiscard]] Eigen::VectorXd solveLeastSquares(const Eigen::MatrixXd& rows,
                                                const Eigen::VectorXd& right);

}  // namespace hapticast
