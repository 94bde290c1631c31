// SPDX-License-Identifier: MIT
#include "server/vision/motion/rigid_align.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/least_squares.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/base/reduction.hpp"

namespace hapticast::server {

namespace {

using Eigen::Vector3d;

constexpr int kFinestSide_px = 220;   // chosen for time: larger objects use fewer pixels
constexpr int kCoarsestSide_px = 24;  // chosen: the exhaustive search costs its fourth power
constexpr std::size_t kTemplatePoints = 1500;  // chosen: prototypes used 1000 to 2500
// Chosen, as the next two: a fit of fewer is no measurement.
constexpr std::size_t kFewestPoints = 40;
constexpr std::size_t kOutlinePoints = 100;
constexpr std::size_t kFewestOutline = 8;
// Chosen: depth is just valid at the first, and flat at the second.
constexpr float kNearEdge_px = 2.0F;
constexpr float kDeeper_px = 8.0F;
constexpr double kOnward = 1.2;     // of the step between these two, measured on a ball
constexpr double kWellFound = 0.6;  // chosen: share of inliers that makes a search unnecessary
constexpr double kFound = 0.5;      // measured: with fewer the error may be several px
// Of the coarse comparison, chosen: larger differences count as completely different.
constexpr double kUnlikeLevels = 40.0;
constexpr float kUnlike_mm = 60.0F;
constexpr int kCoveredLevel = 200;  // of 255: coarse pixels mostly covered by the object

}  // namespace

RigidTemplate::RigidTemplate(const cv::Mat& gray, const Surface& surface, const CameraModel& camera)
    : camera_(camera), box_(surface.box) {
  const int side = std::max(box_.width, box_.height);
  const int finest = std::max(1, (side + kFinestSide_px - 1) / kFinestSide_px);
  const cv::Mat known = surface.mask & (surface.depth > 0);
  if (cv::countNonZero(known) < static_cast<int>(kFewestPoints)) return;
  double near_mm = 0;
  double far_mm = 0;
  cv::minMaxLoc(surface.depth, &near_mm, &far_mm, nullptr, nullptr, known);
  depth_ = {near_mm, far_mm};
  addLevel(gray, surface, finest);
  addLevel(gray, surface, 2 * finest);
  if (levels_[0].points.size() < kFewestPoints) levels_.clear();
  if (!levels_.empty() && outline_mm_.size() < kFewestOutline) {
    for (const RigidPoint& point : levels_[0].points) outline_mm_.push_back(point.position_mm);
  }
  coarse_.factor = std::max(1, (side + kCoarsestSide_px - 1) / kCoarsestSide_px);
  const int f = coarse_.factor;
  coarse_.box_px = {box_.x / f, box_.y / f, box_.width / f, box_.height / f};
  const cv::Size size = coarse_.box_px.size();
  if (size.empty()) return;
  const int by = surface.reduction;
  cv::resize(sampleEvery(gray(box_), by), coarse_.gray, size, 0, 0, cv::INTER_AREA);
  cv::resize(sampleEvery(surface.mask, by), coarse_.mask, size, 0, 0, cv::INTER_AREA);
  cv::resize(surface.depth, coarse_.depth, size, 0, 0, cv::INTER_NEAREST);
}

void RigidTemplate::addLevel(const cv::Mat& gray, const Surface& surface, int factor) {
  Level level;
  level.factor = factor;
  const cv::Size size(box_.width / factor * factor, box_.height / factor * factor);
  if (size.width >= 3 * factor && size.height >= 3 * factor) {
    const cv::Rect part({0, 0}, size);
    const cv::Mat smooth_gray = smoothGray(gray(cv::Rect(box_.tl(), size)), factor);
    const cv::Mat known = surface.mask(part) & (surface.depth(part) > 0);
    const cv::Mat depth = smoothDepth(surface.depth(part), known, factor);
    cv::Mat inside = shrinkImage(known, factor) > 250;
    if (levels_.empty()) addOutline(inside, depth, factor);
    inside = erodeBy(inside, 2);
    const auto count = static_cast<std::size_t>(cv::countNonZero(inside));
    const int step =
        std::max(1, static_cast<int>(std::sqrt(double(count) / kTemplatePoints) + 0.7));
    for (int v = 1; v < inside.rows - 1; v += step) {
      for (int u = 1; u < inside.cols - 1; u += step) {
        if (inside.at<uchar>(v, u) == 0) continue;
        const auto z = static_cast<double>(depth.at<float>(v, u));
        if (z <= 0) continue;
        level.points.push_back({unproject(u, v, z, factor), smooth_gray.at<float>(v, u)});
      }
    }
  }
  levels_.push_back(std::move(level));
}

Vector3d RigidTemplate::unproject(int u, int v, double depth_mm, int factor) const {
  return depth_mm * camera_.ray(box_.x + factor * (u + 0.5), box_.y + factor * (v + 0.5));
}

// Depth is not valid close to the outline, where a body curves away. It is extrapolated as the
// square root of the distance to the outline, as on a ball.
void RigidTemplate::addOutline(const cv::Mat& inside, const cv::Mat& depth, int factor) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(inside, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::Mat distance;
  cv::distanceTransform(inside, distance, cv::DIST_L2, 3);
  const cv::Rect whole(1, 1, inside.cols - 2, inside.rows - 2);
  std::size_t total = 0;
  for (const auto& contour : contours) total += contour.size();
  const std::size_t step = std::max<std::size_t>(1, total / kOutlinePoints);
  for (const auto& contour : contours) {
    for (std::size_t i = 0; i < contour.size(); i += step) {
      const cv::Point& edge = contour[i];
      if (!whole.contains(edge)) continue;
      const cv::Point2f inward(
          distance.at<float>(edge.y, edge.x + 1) - distance.at<float>(edge.y, edge.x - 1),
          distance.at<float>(edge.y + 1, edge.x) - distance.at<float>(edge.y - 1, edge.x));
      const double length = cv::norm(inward);
      if (length < 0.1) continue;
      const auto depthAt = [&](float px) {
        const cv::Point at(cv::Point2f(edge) + inward * (px / static_cast<float>(length)));
        return whole.contains(at) ? static_cast<double>(depth.at<float>(at)) : 0.0;
      };
      const double near_edge = depthAt(kNearEdge_px);
      const double deeper = depthAt(kDeeper_px);
      if (near_edge <= 0 || deeper <= 0) continue;
      const double at_edge = near_edge + kOnward * (near_edge - deeper);
      outline_mm_.push_back(unproject(edge.x, edge.y, at_edge, factor));
    }
  }
}

cv::Rect RigidTemplate::findBox(const Vector3d& pivot_mm, const RigidStep& step,
                                const cv::Size& picture) const {
  const Vector3d to = pivot_mm + step.shift_mm;
  const double scale = std::clamp(pivot_mm.z() / std::max(1.0, to.z()), 0.5, 2.0);
  const Vec2 moved_px = camera_.project(to) - camera_.project(pivot_mm);
  const int factor = levels_.back().factor;
  const int margin = 8 * factor + static_cast<int>((std::abs(scale - 1.0) + 0.08) *
                                                   std::max(box_.width, box_.height));
  const double reach = 4.0 * picture.width;
  const auto whole = [&](double px) {
    return static_cast<int>(std::lround(std::clamp(px, -reach, reach)));
  };
  const cv::Rect moved = box_ + cv::Point(whole(moved_px.x()), whole(moved_px.y()));
  return cv::Rect(moved.x - margin, moved.y - margin, moved.width + 2 * margin,
                  moved.height + 2 * margin) &
         cv::Rect({0, 0}, picture);
}

RigidStep RigidTemplate::align(const FrameImages& images, const Vector3d& pivot_mm,
                               const RigidStep& guess) const {
  RigidStep now = guess;
  now.inliers = 0.0;
  const cv::Rect area = findBox(pivot_mm, guess, images.gray.size());
  const Vector3d expected_turn_rad = rotationVector(guess.rotation);
  const DepthRange depths{depth_.near_mm + std::min(0.0, guess.shift_mm.z()),
                          depth_.far_mm + std::max(0.0, guess.shift_mm.z())};
  for (auto level = levels_.rbegin(); level != levels_.rend(); ++level) {
    const RigidRoi crop = cropRoi(images, area, level->factor, depths);
    if (crop.texels.empty() || level->points.size() < kFewestPoints / 2) continue;
    RigidFit fit(camera_, crop, level->points, pivot_mm, expected_turn_rad);
    if (!fit.improve(now)) return guess;
  }
  return now;
}

double RigidTemplate::Coarse::computeLikeness(const cv::Mat& other_gray, const cv::Mat& other_depth,
                                              const cv::Point& at) const {
  double sum = 0;
  for (int j = 0; j < box_px.height; j += 2) {
    for (int i = 0; i < box_px.width; i += 2) {
      if (mask.at<uchar>(j, i) < kCoveredLevel) continue;
      const int off = std::abs(other_gray.at<uchar>(at.y + j, at.x + i) - gray.at<uchar>(j, i));
      const float z = other_depth.at<float>(at.y + j, at.x + i);
      const float off_depth = z > 0 ? std::abs(z - depth.at<float>(j, i)) : kUnlike_mm;
      // Only similar pixels count; different pixels count nothing.
      sum += std::max(0.0, 1.0 - off / kUnlikeLevels) *
             std::max(0.0, 1.0 - double(off_depth) / double(kUnlike_mm));
    }
  }
  return sum;
}

RigidStep RigidTemplate::searchMotion(const FrameImages& images, const Vector3d& pivot_mm) const {
  RigidStep out;
  const cv::Size size = coarse_.box_px.size();
  if (size.empty() || coarse_.gray.empty()) return out;
  const int f = coarse_.factor;
  const cv::Rect all(0, 0, images.gray.cols / f, images.gray.rows / f);
  const cv::Rect area =
      growRect(coarse_.box_px, 5 * std::max(size.width, size.height) / 2, all.size());
  if (area.width < size.width || area.height < size.height) return out;
  const cv::Rect fine(area.x * f, area.y * f, area.width * f, area.height * f);
  cv::Mat gray;
  cv::Mat depth;
  cv::resize(images.gray(fine), gray, area.size(), 0, 0, cv::INTER_AREA);
  cv::resize(images.depth(fine), depth, area.size(), 0, 0, cv::INTER_NEAREST);
  double best = 0.0;
  cv::Point moved_px;
  for (int v = 0; v + size.height <= area.height; ++v) {
    for (int u = 0; u + size.width <= area.width; ++u) {
      const double likeness = coarse_.computeLikeness(gray, depth, {u, v});
      if (likeness <= best) continue;
      best = likeness;
      moved_px = f * (cv::Point(u, v) + area.tl() - coarse_.box_px.tl());
    }
  }
  if (best <= 0) return out;
  out.shift_mm = {moved_px.x * pivot_mm.z() / camera_.fx_px,
                  moved_px.y * pivot_mm.z() / camera_.fy_px, 0.0};
  return out;
}

RigidStep RigidTemplate::find(const FrameImages& images, const Vector3d& pivot_mm,
                              const RigidStep& guess) const {
  if (levels_.empty()) return guess;
  RigidStep best = align(images, pivot_mm, guess);
  if (best.inliers < kWellFound) {
    RigidStep start = searchMotion(images, pivot_mm);
    start.rotation = guess.rotation;
    const RigidStep other = align(images, pivot_mm, start);
    if (other.inliers > best.inliers) best = other;
  }
  best.reliable = best.inliers >= kFound;
  best.similarity = computeSimilarity(pivot_mm, best);
  return best;
}

cv::Matx23d RigidTemplate::computeSimilarity(const Vector3d& pivot_mm,
                                             const RigidStep& step) const {
  // Least squares for (a, b, s, t) of u' = a u - b v + s, v' = b u + a v + t.
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  const Vec2 half(0.5, 0.5);  // to pixel centres at whole numbers
  for (const Vector3d& x : outline_mm_) {
    const Vec2 from = camera_.project(x) - half;
    const Vec2 to =
        camera_.project(step.rotation * (x - pivot_mm) + pivot_mm + step.shift_mm) - half;
    const Eigen::Vector4d ru(from.x(), -from.y(), 1, 0);
    const Eigen::Vector4d rv(from.y(), from.x(), 0, 1);
    matrix += ru * ru.transpose() + rv * rv.transpose();
    right += ru * to.x() + rv * to.y();
  }
  const Eigen::Vector4d s = solveNormal(matrix, right);
  return s.allFinite() ? cv::Matx23d(s[0], -s[1], s[2], s[1], s[0], s[3]) : step.similarity;
}

}  // namespace hapticast::server
