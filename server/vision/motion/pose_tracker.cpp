// SPDX-License-Identifier: MIT
#include "server/vision/motion/pose_tracker.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"
#include "server/vision/motion/reference_point.hpp"

namespace hapticast::server {

namespace {

// Share of the way from the predicted point to the point of outline and depth, for each frame.
// Tuned on scenes with exact truth (evaluate: motion): a larger share adds noise of the outline, a
// smaller one leaves drift.
constexpr double kPull = 0.035;
constexpr double kSpherePull = 0.03;  // tuned likewise; a sphere's centre is exact
// Limit of the pull in a frame, px and share of the motion. A changing outline is no motion, but
// the error of a wrong centre grows with the motion. Tuned likewise.
constexpr double kStrongestPull_px = 0.1;
constexpr double kStrongestShare = 0.07;
// Measured: alignment errors of a scene at rest; smaller steps count as none.
constexpr double kStill_px = 0.03;
constexpr double kStill_rad = 0.0015;
constexpr double kStill_mm = 0.05;
constexpr double kTrimFloor_mm = 3.0;   // at least an 8-bit level: MAD is 0 on whole numbers
constexpr double kInnerMask = 0.15;     // chosen: share of the largest distance to the rim
constexpr double kWhole = 0.93;         // chosen: visible fraction below which the outline misleads
constexpr double kVisibleEnough = 0.5;  // measured: with less, alignment errs by 4 to 15 px
constexpr std::size_t kFewestInCommon = 20;  // chosen, common pixels of two surfaces
const cv::Point2d kHalfPixel(0.5, 0.5);      // from centres at whole numbers to centres at +0.5

double computeTrimmedMean(std::vector<double>& values, double floor_mm) {
  const double median = computeMedian(values);
  std::vector<double> off;
  off.reserve(values.size());
  for (const double value : values) off.push_back(std::abs(value - median));
  const double limit = std::max(floor_mm, 3 * sigmaByMedian(off));
  double sum = 0;
  int count = 0;
  for (const double value : values) {
    if (std::abs(value - median) > limit) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / count : median;
}

// Means over large objects are as exact from every second pixel and row.
int latticeStep(const cv::Size& size) { return size.area() > kDense_px ? 2 : 1; }

// Returns whether the mode is neither of the thesis's special cases.
bool measuresBothWays(MotionMode mode) {
  return mode == MotionMode::kAuto || mode == MotionMode::kRgbd;
}

// Returns the mean working depth of the inner mask; the rim has the sensor's largest errors.
double computeDepth_mm(const Surface& surface) {
  cv::Mat mask = surface.mask;
  cv::Mat depth = surface.depth;
  if (const int step = latticeStep(mask.size()); step > 1) {
    const cv::Size smaller(mask.cols / step, mask.rows / step);
    cv::resize(mask, mask, smaller, 0, 0, cv::INTER_NEAREST);
    cv::resize(depth, depth, smaller, 0, 0, cv::INTER_NEAREST);
  }
  cv::Mat inside;
  cv::copyMakeBorder(mask, inside, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::distanceTransform(inside, inside, cv::DIST_L2, 3);
  double deepest = 0.0;
  cv::minMaxLoc(inside, nullptr, &deepest);
  const cv::Mat inner = inside(cv::Rect({1, 1}, mask.size())) > kInnerMask * deepest;
  return cv::mean(depth, inner & (depth > 0))[0];
}

}  // namespace

std::optional<double> depthDifference_mm(const Surface& before, const Surface& now,
                                         const cv::Matx23d& similarity, double floor_mm) {
  cv::Mat valid = erodeBy(before.mask, 3) & before.measured;
  valid = warpImage(valid, before.box, now.box, similarity, cv::INTER_NEAREST);
  const cv::Mat depth = warpImage(before.depth, before.box, now.box, similarity, cv::INTER_LINEAR);
  valid &= erodeBy(now.mask, 3) & now.measured;
  std::vector<double> differences;
  const int step = latticeStep(valid.size());
  for (int v = 0; v < valid.rows; v += step) {
    for (int u = 0; u < valid.cols; u += step) {
      if (valid.at<unsigned char>(v, u) == 0) continue;
      differences.push_back(double(now.depth.at<float>(v, u)) - double(depth.at<float>(v, u)));
    }
  }
  if (differences.size() < kFewestInCommon) return std::nullopt;
  return computeTrimmedMean(differences, floor_mm);
}

PoseTracker::PoseTracker(const PoseSettings& settings, const cv::Mat& gray, const Surface& first)
    : settings_(settings), last_(computeShape(first)), fresh_(first) {
  pose_.u_px = last_.centroid.x;
  pose_.v_px = last_.centroid.y;
  pose_.depth_mm = computeDepth_mm(first);
  if (!settings_.rigid) return;
  const BodyCentre centre = computeCentre(first, settings_.camera);
  if (centre.position_mm.z() > 0) setPosition(centre.position_mm);
  remember(gray, first);
}

Vec3 PoseTracker::position_mm() const {
  return pose_.depth_mm * settings_.camera.ray(pose_.u_px, pose_.v_px);
}

void PoseTracker::setPosition(const Vec3& position_mm) {
  pose_.depth_mm = std::max(1.0, position_mm.z());
  const Vec2 observation =
      settings_.camera.project({position_mm.x(), position_mm.y(), pose_.depth_mm});
  pose_.u_px = observation.x();
  pose_.v_px = observation.y();
}

void PoseTracker::remember(const cv::Mat& gray, const Surface& surface) {
  if (settings_.rigid) template_ = RigidTemplate(gray, surface, settings_.camera);
}

std::optional<ObjectFlow> PoseTracker::find(const FrameImages& images) {
  step_ = {};
  if (!settings_.rigid || template_.empty()) return std::nullopt;
  step_ = template_.find(images, position_mm(), last_step_);
  if (!step_.reliable) return std::nullopt;
  ObjectFlow flow;
  flow.similarity = step_.similarity;
  flow.reliable = flow.rotation_reliable = true;
  return flow;
}

void PoseTracker::advanceRigidly(const Observation& observation, bool trusted) {
  const Vec3 turn_rad = rotationVector(step_.rotation);
  const Vec3 before = position_mm();
  const double per_px_mm = before.z() / settings_.camera.fx_px;
  Vec3 shift = step_.shift_mm;
  if (shift.head<2>().norm() < kStill_px * per_px_mm && std::abs(shift.z()) < kStill_mm) {
    shift.setZero();
  } else if (trusted) {
    const BodyCentre centre = computeCentre(observation.surface, settings_.camera);
    if (centre.position_mm.z() > 0) {
      const Vec3 pull =
          (centre.sphere ? kSpherePull : kPull) * (centre.position_mm - before - shift);
      const double most = kStrongestPull_px * per_px_mm + kStrongestShare * shift.norm();
      shift += pull * std::min(1.0, most / std::max(1e-9, pull.norm()));
    }
    pose_.point = centre.sphere ? ReferencePoint::kCentreOfMass : ReferencePoint::kVisibleCentroid;
  }
  setPosition(before + shift);
  if (std::abs(turn_rad.z()) >= kStill_rad) pose_.angle_rad -= turn_rad.z();
  last_step_ = step_;
  aligned_ = true;
  aligned_about_mm_ = before;
}

PredictedMotion PoseTracker::predictMotion() const {
  return [camera = settings_.camera, rotation = last_step_.rotation, about_mm = aligned_about_mm_,
          shift_mm = last_step_.shift_mm](const cv::Point2f& at_px, double depth_mm) -> cv::Vec3d {
    const Vec2 was(double(at_px.x) + 0.5, double(at_px.y) + 0.5);
    const Vec3 from = depth_mm * camera.ray(was.x(), was.y());
    const Vec3 to = rotation * (from - about_mm) + about_mm + shift_mm;
    if (depth_mm <= 0 || to.z() <= 1.0) return {0, 0, 0};
    const Vec2 moved = camera.project(to) - was;
    return {moved.x(), moved.y(), to.z() - depth_mm};
  };
}

PoseTracker::Shape PoseTracker::computeShape(const Surface& surface) const {
  Shape out;
  const cv::Moments moments = cv::moments(surface.mask, true);
  out.area_px = moments.m00;
  out.centroid = computeCentroid(moments, surface.box.tl()) + kHalfPixel;
  const cv::Point end = surface.box.br();
  out.entire = surface.box.x > 0 && surface.box.y > 0 && end.x < settings_.picture.width &&
               end.y < settings_.picture.height;
  return out;
}

void PoseTracker::advanceInPlane(const Observation& observation, const Shape& now, bool trusted) {
  if (settings_.mode == MotionMode::kDepth) return;
  const cv::Point2d before(pose_.u_px, pose_.v_px);
  cv::Point2d step = observation.flow.warp(before - kHalfPixel) + kHalfPixel - before;
  const bool follow_centroid = trusted && measuresBothWays(settings_.mode) &&
                               (settings_.exact_masks || !observation.flow.reliable);
  if (follow_centroid) step = now.centroid - last_.centroid;
  const bool at_rest =
      observation.flow.reliable && !settings_.exact_masks && cv::norm(step) < kStill_px;
  if (at_rest) step = {0, 0};
  if (trusted && !follow_centroid && !at_rest) step += kPull * (now.centroid - before - step);
  pose_.u_px += step.x;
  pose_.v_px += step.y;
  const double turn = observation.flow.rotation_reliable ? observation.flow.rotation_rad() : 0.0;
  if (std::abs(turn) >= kStill_rad) pose_.angle_rad -= turn;
}

void PoseTracker::advanceInDepth(const Observation& observation, bool trusted) {
  since_fresh_ = homogeneous(observation.flow.similarity) * since_fresh_;
  pose_.depth_seen = !observation.repeated;
  if (settings_.mode == MotionMode::kLk || observation.repeated) return;
  if (settings_.exact_masks && trusted && measuresBothWays(settings_.mode)) {
    pose_.depth_mm += computeDepth_mm(observation.surface) - computeDepth_mm(fresh_);
  } else {
    const cv::Matx23d carry = since_fresh_.get_minor<2, 3>(0, 0);
    const double step =
        depthDifference_mm(fresh_, observation.surface, carry, kTrimFloor_mm).value_or(0.0);
    if (std::abs(step) >= kStill_mm) {
      pose_.depth_mm += step;
      // An aligned body follows its centre, not its visible surface.
      if (trusted && !settings_.rigid)
        pose_.depth_mm += kPull * (computeDepth_mm(observation.surface) - pose_.depth_mm);
    }
  }
  fresh_ = observation.surface;
  since_fresh_ = cv::Matx33d::eye();
}

ObjectPose PoseTracker::advance(const Observation& observation) {
  pose_.depth_seen = pose_.seen = pose_.confident = true;
  aligned_ = false;
  // The references stay too, so that a slow drift at rest is corrected afterwards.
  if (settings_.mode == MotionMode::kNone || observation.at_rest) {
    step_ = last_step_ = {};
    return pose_;
  }
  const Shape now = computeShape(observation.surface);
  const double growth = now.area_px / std::max(1.0, last_.area_px);
  const bool trusted = now.entire && last_.entire && growth > 0.8 && growth < 1.25 &&
                       observation.visible_fraction > kWhole;
  pose_.seen = observation.visible_fraction >= kVisibleEnough;
  if (step_.reliable) {
    advanceRigidly(observation, trusted);
    fresh_ = observation.surface;
    since_fresh_ = cv::Matx33d::eye();
  } else {
    const Vec3 before = position_mm();
    advanceInPlane(observation, now, trusted);
    advanceInDepth(observation, trusted);
    last_step_ = {};
    last_step_.shift_mm = position_mm() - before;
    pose_.confident = !settings_.rigid;
  }
  step_ = {};
  last_ = now;
  remember(observation.gray, observation.surface);
  return pose_;
}

}  // namespace hapticast::server
