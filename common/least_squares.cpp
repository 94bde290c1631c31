// SPDX-License-Identifier: MIT
#include "common/least_squares.hpp"

#include <Eigen/Dense>

namespace hapticast {

Eigen::Vector3d solveNormal(const Eigen::Matrix3d& normal, const Eigen::Vector3d& right) {
  return normal.ldlt().solve(right);
}

Eigen::Vector4d solveNormal(const Eigen::Matrix4d& normal, const Eigen::Vector4d& right) {
  return normal.ldlt().solve(right);
}

Eigen::Matrix<double, 6, 1> solveNormal(const Eigen::Matrix<double, 6, 6>& normal,
                                        const Eigen::Matrix<double, 6, 1>& right) {
  return normal.ldlt().solve(right);
}

Eigen::VectorXd solveLeastSquares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right) {
  return rows.colPivHouseholderQr().solve(right);
}

}  // namespace hapticast
