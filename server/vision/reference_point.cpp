// SPDX-License-Identifier: MIT
#include "server/vision/reference_point.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace hapticast::server {

namespace {

using Eigen::Vector3d;

constexpr double kRoundest = 0.93;      // shorter over longer axis of the outline, at least
constexpr double kFitResidual = 0.03;   // of the radius
constexpr double kRadiusAgrees = 0.08;  // fitted against that of the outline
constexpr std::size_t kFitPoints = 1000;
constexpr double kDomeResidual = 0.03;  // of an ellipsoid's depth
// Of what is neither ball nor ellipsoid: from the mean depth to the centre, against the spread (5
// to 95 %) of the depths. A box has 0.6 edge on, 1.1 corner on.
constexpr double kBehindPerSpread = 0.89;

struct Outline {
  double u_px = 0, v_px = 0;  // centroid, pixel centres at +0.5
  double radius_px = 0;       // of the disc of this area
  double roundness = 0;
  Eigen::Matrix2d shape = Eigen::Matrix2d::Zero();  // 1 on the ellipse of the same moments
};

Outline outlineOf(const Surface& surface) {
  const cv::Moments m = cv::moments(surface.mask, true);
  Outline out;
  if (m.m00 <= 0) return out;
  out.u_px = surface.box.x + m.m10 / m.m00 + 0.5;
  out.v_px = surface.box.y + m.m01 / m.m00 + 0.5;
  out.radius_px = std::sqrt(m.m00 / CV_PI);
  const double mean = 0.5 * (m.mu20 + m.mu02);
  const double off = std::hypot(0.5 * (m.mu20 - m.mu02), m.mu11);
  Eigen::Matrix2d spread;
  spread << m.mu20 / m.m00, m.mu11 / m.m00, m.mu11 / m.m00, m.mu02 / m.m00;
  if (spread.determinant() > 1.0) out.shape = (4.0 * spread).inverse();
  out.roundness = mean + off > 0 ? std::sqrt(std::max(0.0, mean - off) / (mean + off)) : 0.0;
  return out;
}

// The inner part of the surface: its rim is the sensor's worst.
std::vector<Vector3d> innerPoints(const Surface& surface, const CameraModel& camera,
                                  double radius_px) {
  const int margin = std::clamp(static_cast<int>(0.12 * radius_px), 1, 12);
  const cv::Mat inner = erodedBy(surface.mask, margin) & (surface.depth > 0);
  cv::Mat smooth;  // a sensor's noise is no sign of another shape
  const int window = 2 * (2 * margin / 3) + 1;
  cv::blur(surface.depth, smooth, {window, window});
  const double count = cv::countNonZero(inner);
  const int step = std::max(1, static_cast<int>(std::sqrt(count / kFitPoints)));
  std::vector<Vector3d> out;
  for (int v = 0; v < inner.rows; v += step) {
    for (int u = 0; u < inner.cols; u += step) {
      if (inner.at<uchar>(v, u) == 0) continue;
      const auto z = static_cast<double>(smooth.at<float>(v, u));
      out.emplace_back((surface.box.x + u + 0.5 - camera.cx_px) / camera.fx_px * z,
                       (surface.box.y + v + 0.5 - camera.cy_px) / camera.fy_px * z, z);
    }
  }
  return out;
}

// |X|² = 2 X.C + k, least squares; then how far the points are off it.
struct SphereFit {
  Vector3d centre;
  double radius_mm = 0;
  double residual_mm = 0;
};
SphereFit fitSphere(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Vector3d& p : points) {
    Eigen::Vector4d row;
    row << 2 * (p - mean), 1;
    matrix += row * row.transpose();
    right += row * (p - mean).squaredNorm();
  }
  const Eigen::Vector4d c = matrix.ldlt().solve(right);
  SphereFit out;
  out.centre = c.head<3>() + mean;
  out.radius_mm = std::sqrt(std::max(0.0, c[3] + c.head<3>().squaredNorm()));
  double square = 0;
  for (const Vector3d& p : points) square += std::pow((p - out.centre).norm() - out.radius_mm, 2);
  out.residual_mm = std::sqrt(square / static_cast<double>(points.size()));
  return out;
}

// Of an ellipsoid, however it is turned, seen from afar: its depth is a plane through the centre
// less a dome over the outline, z = z0 + g.x - c sqrt(1 - x.shape.x). nullopt where that does not
// fit.
std::optional<double> ellipsoidDepth_mm(const std::vector<Vector3d>& points, const Outline& outline,
                                        const CameraModel& camera) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  std::vector<Eigen::Vector4d> rows;
  for (const Vector3d& p : points) {
    const Eigen::Vector2d at(camera.fx_px * p.x() / p.z() + camera.cx_px - outline.u_px,
                             camera.fy_px * p.y() / p.z() + camera.cy_px - outline.v_px);
    const double dome = std::sqrt(std::max(0.0, 1.0 - at.dot(outline.shape * at)));
    rows.emplace_back(1.0, at.x() / outline.radius_px, at.y() / outline.radius_px, -dome);
    matrix += rows.back() * rows.back().transpose();
    right += rows.back() * p.z();
  }
  const Eigen::Vector4d c = matrix.ldlt().solve(right);
  if (!c.allFinite() || !(c[3] > 0)) return std::nullopt;
  double square = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    square += std::pow(rows[i].dot(c) - points[i].z(), 2);
  const double residual_mm = std::sqrt(square / static_cast<double>(points.size()));
  if (residual_mm >= kDomeResidual * c[3] || c[0] <= c[3]) return std::nullopt;
  // From nearby the outline lies before the centre: of a ball by r²/z.
  return c[0] + c[3] * c[3] / c[0];
}

}  // namespace

BodyCentre centreOf(const Surface& surface, const CameraModel& camera) {
  BodyCentre out;
  const Outline outline = outlineOf(surface);
  const std::vector<Vector3d> points = innerPoints(surface, camera, outline.radius_px);
  if (points.size() < 8) return out;
  std::vector<double> depths;
  double mean = 0;
  for (const Vector3d& p : points) {
    depths.push_back(p.z());
    mean += p.z() / static_cast<double>(points.size());
  }
  std::sort(depths.begin(), depths.end());
  const double spread = depths[depths.size() * 95 / 100] - depths[depths.size() * 5 / 100];
  const double focal_px = 0.5 * (camera.fx_px + camera.fy_px);
  if (outline.roundness > kRoundest && points.size() >= 40) {
    const SphereFit fit = fitSphere(points);
    const double seen_mm = outline.radius_px / focal_px * fit.centre.z();
    out.sphere = fit.centre.allFinite() && fit.radius_mm > 0 &&
                 fit.residual_mm < kFitResidual * fit.radius_mm &&
                 std::abs(fit.radius_mm - seen_mm) < kRadiusAgrees * seen_mm &&
                 fit.centre.z() > mean;
    out.position_mm = fit.centre;
  }
  if (!out.sphere) {
    const double z =
        ellipsoidDepth_mm(points, outline, camera).value_or(mean + kBehindPerSpread * spread);
    out.position_mm = {(outline.u_px - camera.cx_px) / camera.fx_px * z,
                       (outline.v_px - camera.cy_px) / camera.fy_px * z, z};
  }
  return out;
}

}  // namespace hapticast::server
