// SPDX-License-Identifier: MIT
#include "server/vision/motion/reference_point.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "common/least_squares.hpp"
#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

using Eigen::Vector3d;

// Gate of the sphere model. Measured on a ball and a tumbling ellipsoid: residuals of 0.002 to
// 0.007 against 0.06.
constexpr double kRoundest = 0.93;        // shorter over longer axis of the outline, lower limit
constexpr double kFitResidual = 0.03;     // of the radius
constexpr double kRadiusAgrees = 0.08;    // fitted radius against the outline's radius
constexpr std::size_t kFitPoints = 1000;  // chosen: more points change nothing
constexpr std::size_t kFewestForSphere = 40;
constexpr std::size_t kFewestSurfacePoints = 8;
constexpr double kInnerMargin = 0.12;   // chosen, of the outline's radius
constexpr double kDomeResidual = 0.03;  // of an ellipsoid's depth; chosen equal to the sphere's
// Chosen, for bodies that are neither ball nor ellipsoid: distance from the mean depth to the
// centre, relative to the spread (5 to 95 %) of the depths. A box has 0.6 edge on, 1.1 corner on.
constexpr double kBehindPerSpread = 0.89;

struct Outline {
  double u_px = 0, v_px = 0;  // centroid, pixel centres at +0.5
  double radius_px = 0;       // of the disc of this area
  double roundness = 0;
  Eigen::Matrix2d shape = Eigen::Matrix2d::Zero();  // 1 on the ellipse of the same moments
};

Outline traceOutline(const Surface& surface) {
  const cv::Moments m = cv::moments(surface.mask, true);
  Outline out;
  if (m.m00 <= 0) return out;
  const cv::Point2d centroid = computeCentroid(m, surface.box.tl());
  out.u_px = centroid.x + 0.5;
  out.v_px = centroid.y + 0.5;
  out.radius_px = std::sqrt(m.m00 / CV_PI);
  const double mean = 0.5 * (m.mu20 + m.mu02);
  const double off = std::hypot(0.5 * (m.mu20 - m.mu02), m.mu11);
  Eigen::Matrix2d spread;
  spread << m.mu20 / m.m00, m.mu11 / m.m00, m.mu11 / m.m00, m.mu02 / m.m00;
  if (spread.determinant() > 1.0) out.shape = (4.0 * spread).inverse();
  out.roundness = mean + off > 0 ? std::sqrt(std::max(0.0, mean - off) / (mean + off)) : 0.0;
  return out;
}

// Returns the inner points of the surface; the rim has the sensor's largest errors.
std::vector<Vector3d> innerPoints(const Surface& surface, const CameraModel& camera,
                                  double radius_px) {
  const int margin = std::clamp(static_cast<int>(kInnerMargin * radius_px), 1, 12);
  const cv::Mat inner = erodeBy(surface.mask, margin) & (surface.depth > 0);
  cv::Mat smooth;  // a sensor's noise must not resemble another shape
  const int window = 2 * (2 * margin / 3) + 1;
  cv::blur(surface.depth, smooth, {window, window});
  const double count = cv::countNonZero(inner);
  const int step = std::max(1, static_cast<int>(std::sqrt(count / kFitPoints)));
  std::vector<Vector3d> out;
  for (int v = 0; v < inner.rows; v += step) {
    for (int u = 0; u < inner.cols; u += step) {
      if (inner.at<uchar>(v, u) == 0) continue;
      const auto z = static_cast<double>(smooth.at<float>(v, u));
      out.push_back(z * camera.ray(surface.box.x + u + 0.5, surface.box.y + v + 0.5));
    }
  }
  return out;
}

// Fits |X|² = 2 X.C + k by least squares; the residual is the rms distance to the sphere.
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
  const Eigen::Vector4d c = solveNormal(matrix, right);
  SphereFit out;
  out.centre = c.head<3>() + mean;
  out.radius_mm = std::sqrt(std::max(0.0, c[3] + c.head<3>().squaredNorm()));
  double square = 0;
  for (const Vector3d& p : points) square += std::pow((p - out.centre).norm() - out.radius_mm, 2);
  out.residual_mm = std::sqrt(square / static_cast<double>(points.size()));
  return out;
}

// Returns the centre of an ellipsoid in any orientation; nullopt if the fit is poor. The ellipsoid
// touches the cone over its outline M, X.MX = 0, along a plane m.X = w, so X.MX + (m.X - w)² = 0 on
// it.
// Hence the inverse depth is linear in the picture and in a dome over the outline, 1 / z = p.(x, y,
// 1) + d sqrt(1 - x.shape.x). The centre solves (d² M + p p^T) C = p.
// x: position relative to the outline's centroid, in radii of the outline.
std::optional<Vector3d> ellipsoidCentre_mm(const std::vector<Vector3d>& points,
                                           const Outline& outline, const CameraModel& camera) {
  const Eigen::Matrix2d shape = outline.shape * outline.radius_px * outline.radius_px;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  std::vector<Eigen::Vector4d> rows;
  for (const Vector3d& p : points) {
    const Vec2 at = (camera.project(p) - Vec2(outline.u_px, outline.v_px)) / outline.radius_px;
    const double dome = std::sqrt(std::max(0.0, 1.0 - at.dot(shape * at)));
    rows.emplace_back(at.x(), at.y(), 1.0, dome);
    matrix += rows.back() * rows.back().transpose();
    right += rows.back() / p.z();
  }
  const Eigen::Vector4d fit = solveNormal(matrix, right);
  const Vector3d plane = fit.head<3>();
  const double dome = fit[3];
  if (!fit.allFinite() || !(dome > 0)) return std::nullopt;
  double square = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    square += std::pow(rows[i].dot(fit) - 1.0 / points[i].z(), 2);
  if (std::sqrt(square / static_cast<double>(points.size())) >= kDomeResidual * dome)
    return std::nullopt;
  Eigen::Matrix3d body = plane * plane.transpose();
  body.topLeftCorner<2, 2>() += dome * dome * shape;
  body(2, 2) -= dome * dome;
  if (!(body.determinant() > 0)) return std::nullopt;
  const Vector3d centre = solveNormal(body, plane);
  const Vec2 seen =
      Vec2(outline.u_px, outline.v_px) + outline.radius_px / centre.z() * centre.head<2>();
  return centre.z() * camera.ray(seen.x(), seen.y());
}

}  // namespace

BodyCentre computeCentre(const Surface& surface, const CameraModel& camera) {
  const Outline outline = traceOutline(surface);
  const std::vector<Vector3d> points = innerPoints(surface, camera, outline.radius_px);
  if (points.size() < kFewestSurfacePoints) return {};
  std::vector<double> depths;
  double mean = 0;
  for (const Vector3d& p : points) {
    depths.push_back(p.z());
    mean += p.z() / static_cast<double>(points.size());
  }
  std::sort(depths.begin(), depths.end());
  const double spread = depths[depths.size() * 95 / 100] - depths[depths.size() * 5 / 100];
  const double focal_px = 0.5 * (camera.fx_px + camera.fy_px);
  if (outline.roundness > kRoundest && points.size() >= kFewestForSphere) {
    const SphereFit fit = fitSphere(points);
    const double seen_mm = outline.radius_px / focal_px * fit.centre.z();
    const bool sphere = fit.centre.allFinite() && fit.radius_mm > 0 &&
                        fit.residual_mm < kFitResidual * fit.radius_mm &&
                        std::abs(fit.radius_mm - seen_mm) < kRadiusAgrees * seen_mm &&
                        fit.centre.z() > mean;
    if (sphere) return {fit.centre, true};
  }
  const double z = mean + kBehindPerSpread * spread;
  const Vector3d blob = z * camera.ray(outline.u_px, outline.v_px);
  return {ellipsoidCentre_mm(points, outline, camera).value_or(blob)};
}

}  // namespace hapticast::server
