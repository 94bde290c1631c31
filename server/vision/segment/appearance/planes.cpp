// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/planes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/least_squares.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr double kUsualFocal = 0.94;  // relative to the width: field of view of most cameras
constexpr int kLattice_px =
    4;  // chosen for time, for pictures up to kUsualWidth_px; larger ones have as many points
constexpr int kFollowed = 2;   // factor of a coarser lattice for refits (chosen for time)
constexpr int kTriples = 250;  // chosen: almost surely finds a plane with 6 % of the picture
constexpr double kSmallestPlane = 0.06;   // chosen, of the picture: size of tables and walls
constexpr double kSmallestGround = 0.02;  // the same limit for ground planes
// Measured on real clips: tables have a slope of 1.6 and more, sides of people at most 1.3.
constexpr double kGroundSlope = 1.45;
constexpr double kSupportingRing = 0.08;  // chosen, of the ring around an object
// Chosen: a smaller plane may be the front of the object. It is a support only if most of the
// object lies in front of it.
constexpr double kSurelySupport = 0.15;
constexpr double kInFront = 0.7;

struct LatticePoint {
  double u, v, z;
};

struct Lattice {
  std::vector<LatticePoint> points;
  double whole = 1.0;  // number of points if all depths were measured
};

Lattice makeLattice(const cv::Mat& depth, int coarser) {
  Lattice out;
  const int step = coarser * kLattice_px * std::max(1, depth.cols / kUsualWidth_px);
  for (int v = step / 2; v < depth.rows; v += step) {
    const auto* row = depth.ptr<float>(v);
    for (int u = step / 2; u < depth.cols; u += step) {
      if (row[u] > 0.0F) out.points.push_back({double(u), double(v), double(row[u])});
    }
  }
  out.whole = double(depth.rows) * depth.cols / (step * step);
  return out;
}

bool fitPlaneThrough(const LatticePoint& p, const LatticePoint& q, const LatticePoint& r,
                     Plane& plane) {
  Eigen::Matrix3d points;
  points << p.u, p.v, 1, q.u, q.v, 1, r.u, r.v, 1;
  if (std::abs(points.determinant()) < 50.0) return false;
  const Eigen::Vector3d abc = points.inverse() * Eigen::Vector3d(1 / p.z, 1 / q.z, 1 / r.z);
  plane.a = abc[0];
  plane.b = abc[1];
  plane.c = abc[2];
  return true;
}

// One weighted fit of the points within `width` tolerances. Returns their number.
int fitOnce(const std::vector<LatticePoint>& points, double width, Plane& plane) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::vector<double> residuals;
  for (const LatticePoint& p : points) {
    const double off = plane.behind(p.u, p.v, p.z) / width;
    if (std::abs(off) > 1.0) continue;
    const double weight = (1 - off * off) * (1 - off * off);
    const Eigen::Vector3d x(p.u, p.v, 1.0);
    normal += weight * x * x.transpose();
    right += weight / p.z * x;
    residuals.push_back(std::abs(p.z * p.z * (1 / p.z - plane.inverse(p.u, p.v))));
  }
  if (residuals.size() < 10) return 0;
  const Eigen::Vector3d abc = solveNormal(normal, right);
  if (!abc.allFinite()) return 0;
  plane.a = abc[0];
  plane.b = abc[1];
  plane.c = abc[2];
  const int count = static_cast<int>(residuals.size());
  // Limited by the noise: a fit that widens itself would include the objects on the plane.
  plane.tolerance_mm = std::min(plane.widest_mm, 3 * sigmaByMedian(residuals) + 2.0);
  return count;
}

int countInliers(const std::vector<LatticePoint>& points, const Plane& plane, std::size_t every) {
  int count = 0;
  for (std::size_t i = 0; i < points.size(); i += every) {
    count += std::abs(plane.behind(points[i].u, points[i].v, points[i].z)) <= 1.0 ? 1 : 0;
  }
  return count;
}

Plane bestPlane(const std::vector<LatticePoint>& points, const DepthNoise& noise, double near_px,
                cv::RNG& random) {
  Plane best;
  int most = 0;
  const int size = static_cast<int>(points.size());
  const std::size_t every = std::max<std::size_t>(1, points.size() / 2500);
  for (int i = 0; i < kTriples; ++i) {
    const LatticePoint& p = points[static_cast<std::size_t>(random.uniform(0, size))];
    const LatticePoint& q = points[static_cast<std::size_t>(random.uniform(0, size))];
    const LatticePoint& r = points[static_cast<std::size_t>(random.uniform(0, size))];
    const bool close =
        std::hypot(p.u - q.u, p.v - q.v) < near_px && std::hypot(p.u - r.u, p.v - r.v) < near_px;
    Plane plane;
    if ((i % 2 == 0 && !close && random.uniform(0, 4) != 0) || !fitPlaneThrough(p, q, r, plane))
      continue;
    // Correlated noise is underestimated 2 to 3 times.
    plane.widest_mm = 8 * noise.at(std::min({p.z, q.z, r.z})) + 2.0;
    plane.tolerance_mm = plane.widest_mm;
    const int count = countInliers(points, plane, every);
    if (count <= most) continue;
    most = count;
    best = plane;
  }
  return best;
}

// Returns whether the plane is a table or floor: seen at a grazing angle. The picture may be
// turned, so the direction does not count.
bool isGround(const std::vector<LatticePoint>& points, const Plane& plane,
              double px_per_mm_at_1mm) {
  std::vector<double> ranges;
  for (const LatticePoint& p : points) {
    if (std::abs(plane.behind(p.u, p.v, p.z)) <= 1.0) ranges.push_back(p.z);
  }
  const double range = computeMedian(ranges);
  // Both sides in space: mm of depth for each mm across the view.
  return range * std::hypot(plane.a, plane.b) * px_per_mm_at_1mm > kGroundSlope;
}

}  // namespace

double Plane::behind(double u, double v, double depth_mm) const {
  const double square = depth_mm * depth_mm;
  const double slope = std::min(0.02 * depth_mm, 1.5 * square * (std::abs(a) + std::abs(b)));
  const double tolerance = tolerance_mm + slope;
  return square * (inverse(u, v) - 1 / depth_mm) / tolerance;
}

std::vector<Plane> findPlanes(const cv::Mat& depth, const DepthNoise& noise) {
  auto [points, whole] = makeLattice(depth, 1);
  cv::RNG random(7);
  std::vector<Plane> planes;
  for (int round = 0; round < 5 && planes.size() < 3; ++round) {
    if (double(points.size()) < kSmallestGround * whole) break;
    Plane plane = bestPlane(points, noise, 0.12 * depth.cols, random);
    for (int i = 0; i < 5; ++i) plane.share = fitOnce(points, i < 2 ? 2.0 : 1.0, plane) / whole;
    if (plane.share < kSmallestGround) break;
    if (plane.share >= kSmallestPlane || isGround(points, plane, pixelsPerMm(1.0, depth.size())))
      planes.push_back(plane);
    std::erase_if(points, [&](const LatticePoint& p) {
      return std::abs(plane.behind(p.u, p.v, p.z)) <= 1.0;
    });
  }
  return planes;
}

bool refitPlanes(const cv::Mat& depth, std::vector<Plane>& planes) {
  if (planes.empty()) return true;
  auto [points, whole] = makeLattice(depth, kFollowed);
  bool held = true;
  for (Plane& plane : planes) {
    const double before = plane.share;
    fitOnce(points, 2.0, plane);
    plane.share = fitOnce(points, 1.0, plane) / whole;
    held = held && plane.share >= 0.6 * before;
    std::erase_if(points, [&](const LatticePoint& p) {
      return std::abs(plane.behind(p.u, p.v, p.z)) <= 1.0;
    });
  }
  return held;
}

bool isOnPlanes(const std::vector<Plane>& planes, double u, double v, double depth_mm) {
  return std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
    const double behind = plane.behind(u, v, depth_mm);
    return behind >= -1.0 && (behind <= 1.0 || plane.support);
  });
}

cv::Mat findOnPlanes(const cv::Mat& depth, const cv::Rect& box, const std::vector<Plane>& planes) {
  cv::Mat out = cv::Mat::zeros(box.size(), CV_8UC1);
  for (int v = 0; v < box.height; ++v) {
    const auto* row = depth.ptr<float>(v + box.y) + box.x;
    auto* to = out.ptr<unsigned char>(v);
    for (int u = 0; u < box.width; ++u) {
      if (row[u] <= 0.0F) continue;
      if (isOnPlanes(planes, u + box.x, v + box.y, double(row[u]))) to[u] = 255;
    }
  }
  return out;
}

namespace {

// Returns the share of the measured pixels of `mask` that lie in front of the plane.
double shareInFront(const cv::Mat& depth, const cv::Mat& mask, const Plane& plane) {
  int measured = 0;
  int in_front = 0;
  for (int v = 0; v < mask.rows; v += 2) {
    for (int u = 0; u < mask.cols; u += 2) {
      if (mask.at<unsigned char>(v, u) == 0 || depth.at<float>(v, u) <= 0.0F) continue;
      ++measured;
      in_front += plane.behind(u, v, double(depth.at<float>(v, u))) < -1.0 ? 1 : 0;
    }
  }
  return double(in_front) / std::max(1, measured);
}

}  // namespace

void findSupports(const cv::Mat& depth, const cv::Mat& mask, std::vector<Plane>& planes) {
  const cv::Rect box = findBoxAround(mask, 42);
  if (box.empty()) return;
  const cv::Mat ring = dilateBy(mask(box), 40) & (mask(box) == 0);
  const int area = cv::countNonZero(ring);
  for (Plane& plane : planes) {
    const cv::Mat on = findOnPlanes(depth, box, {plane}) & ring;
    const bool carries = cv::countNonZero(on) > kSupportingRing * area;
    plane.support =
        plane.support ||
        (carries && (plane.share > kSurelySupport || shareInFront(depth, mask, plane) > kInFront));
  }
}

double pixelsPerMm(double depth_mm, const cv::Size& picture) {
  return kUsualFocal * std::max(picture.width, picture.height) / std::max(depth_mm, 1.0);
}

}  // namespace hapticast::server
