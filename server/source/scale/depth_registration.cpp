// SPDX-License-Identifier: MIT
#include "server/source/scale/depth_registration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/calib3d.hpp>

namespace hapticast::server {

namespace {

// Chosen: slants enlarge a pixel, and cracks between pixels are worse than a wider outline.
constexpr double kWider = 1.2;

cv::Mat makeDistortion(const LensCamera& camera) {
  return cv::Mat(1, 8, CV_64F, const_cast<double*>(camera.distortion.data()));
}

/// Returns the places at Z = 1 of pixels.
std::vector<cv::Point2d> undistort(const LensCamera& camera,
                                   const std::vector<cv::Point2d>& pixels) {
  const cv::TermCriteria exact(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-9);
  std::vector<cv::Point2d> places;
  cv::undistortPoints(pixels, places, camera.matrix, makeDistortion(camera), cv::noArray(),
                      cv::noArray(), exact);
  return places;
}

/// Returns the largest radius at Z = 1 that the picture of `camera` shows. Farther points would
/// return into the picture by the polynomials of the lens.
double findRadius(const LensCamera& camera) {
  constexpr double kMargin = 1.05;
  constexpr double kMost = 1.7;  // the sensor's own limit
  const double right = camera.size.width - 1.0;
  const double bottom = camera.size.height - 1.0;
  double radius = 0.0;
  for (const cv::Point2d& corner :
       undistort(camera, {{0.0, 0.0}, {right, 0.0}, {0.0, bottom}, {right, bottom}}))
    radius = std::max(radius, cv::norm(corner));
  return radius > 0.0 && radius < kMost ? kMargin * radius : kMost;
}

/// Returns the points at Z = 1 that the pixels of `camera` show. A pixel that no point reaches
/// through the lens has (0, 0, 0).
std::vector<cv::Vec3f> findRays(const LensCamera& camera) {
  std::vector<cv::Point2d> pixels;
  for (int v = 0; v < camera.size.height; ++v) {
    for (int u = 0; u < camera.size.width; ++u) pixels.emplace_back(u, v);
  }
  const std::vector<cv::Point2d> rays = undistort(camera, pixels);
  std::vector<cv::Point3d> points;
  points.reserve(rays.size());
  for (const cv::Point2d& ray : rays) points.emplace_back(ray.x, ray.y, 1.0);
  std::vector<cv::Point2d> back;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), camera.matrix, makeDistortion(camera), back);
  constexpr double kSame_px = 0.1;  // chosen: in the corners the inverse may not converge
  std::vector<cv::Vec3f> out(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (cv::norm(back[i] - pixels[i]) < kSame_px)
      out[i] = cv::Vec3f(static_cast<float>(rays[i].x), static_cast<float>(rays[i].y), 1.0F);
  }
  return out;
}

/// Returns the place of the point (x, y, 1) through the lens, at Z = 1.
cv::Point2d distort(const LensCamera& camera, double x, double y) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  const double r2 = x * x + y * y;
  const double radial =
      (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

/// Returns half the widths of the pixels of a picture of `size` at Z = 1, from their neighbours.
std::vector<float> findHalfWidths(const std::vector<cv::Vec3f>& rays, cv::Size size) {
  std::vector<float> out(rays.size());
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const auto at = [&](int x, int y) {
        return rays[static_cast<std::size_t>(std::min(y, size.height - 1) * size.width +
                                             std::min(x, size.width - 1))];
      };
      const double wide =
          std::max(cv::norm(at(u + 1, v) - at(u, v)), cv::norm(at(u, v + 1) - at(u, v)));
      out[static_cast<std::size_t>(v * size.width + u)] = static_cast<float>(0.5 * wide);
    }
  }
  return out;
}

}  // namespace

DepthRegistration::DepthRegistration(const LensCamera& depth, const LensCamera& color,
                                     const KinectCalibration& calibration)
    : color_(color),
      depth_size_(depth.size),
      radius_(findRadius(color)),
      rays_(findRays(depth)),
      half_widths_(findHalfWidths(rays_, depth.size)),
      translation_mm_(calibration.translation_mm) {
  for (cv::Vec3f& ray : rays_) ray = cv::Matx33f(calibration.rotation) * ray;
  // Pixels of the colour for one of the depth.
  const double ratio = std::max(1.0, color.matrix(0, 0) / depth.matrix(0, 0));
  const auto divide = [ratio](int side_px) {
    return std::max(1, static_cast<int>(std::lround(side_px / ratio)));
  };
  size_ = {divide(color.size.width), divide(color.size.height)};
  // Places of the smaller picture: its pixels count from the middle of the first one, too.
  cv::Matx33d& matrix = color_.matrix;
  const cv::Vec2d scale(static_cast<double>(size_.width) / color.size.width,
                        static_cast<double>(size_.height) / color.size.height);
  for (int i = 0; i < 2; ++i) {
    matrix(i, i) *= scale[i];
    matrix(i, 2) = (matrix(i, 2) + 0.5) * scale[i] - 0.5;
  }
}

void DepthRegistration::splatDepth(const cv::Vec3d& at_mm, double half_mm, cv::Mat& out) const {
  constexpr double kNearest_mm = 1.0;
  constexpr double kFarthest_mm = 65535.0;
  if (!(at_mm[2] >= kNearest_mm && at_mm[2] <= kFarthest_mm)) return;
  const double x = at_mm[0] / at_mm[2];
  const double y = at_mm[1] / at_mm[2];
  if (!(x * x + y * y < radius_ * radius_)) return;
  const cv::Point2d place = distort(color_, x, y);
  const double u = color_.matrix(0, 0) * place.x + color_.matrix(0, 2);
  const double v = color_.matrix(1, 1) * place.y + color_.matrix(1, 2);
  if (!(u > -2.0 && v > -2.0 && u < size_.width + 1.0 && v < size_.height + 1.0)) return;
  constexpr double kMost_px = 3.0;
  const double half_px =
      std::clamp(kWider * half_mm / at_mm[2] * color_.matrix(0, 0), 0.5, kMost_px);
  const auto depth_mm = static_cast<std::uint16_t>(std::lround(at_mm[2]));
  const int u_end = std::min(size_.width - 1, static_cast<int>(std::floor(u + half_px)));
  const int v_end = std::min(size_.height - 1, static_cast<int>(std::floor(v + half_px)));
  for (int y_px = std::max(0, static_cast<int>(std::ceil(v - half_px))); y_px <= v_end; ++y_px) {
    for (int x_px = std::max(0, static_cast<int>(std::ceil(u - half_px))); x_px <= u_end; ++x_px) {
      auto& pixel = out.at<std::uint16_t>(y_px, x_px);
      if (pixel == 0 || depth_mm < pixel) pixel = depth_mm;
    }
  }
}

cv::Mat DepthRegistration::run(const cv::Mat& depth) const {
  cv::Mat out = cv::Mat::zeros(size_, CV_16UC1);
  std::size_t at = 0;
  for (int v = 0; v < depth_size_.height; ++v) {
    const auto* const row = depth.ptr<std::uint16_t>(v);
    for (int u = 0; u < depth_size_.width; ++u, ++at) {
      if (row[u] == 0 || rays_[at] == cv::Vec3f()) continue;
      const auto depth_mm = static_cast<double>(row[u]);
      splatDepth(cv::Vec3d(rays_[at]) * depth_mm + translation_mm_,
                 double{half_widths_[at]} * depth_mm, out);
    }
  }
  return out;
}

}  // namespace hapticast::server
