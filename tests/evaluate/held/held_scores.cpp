// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "tests/evaluate/held/held_run.hpp"
#include "tests/evaluate/vision/vision_parts.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr double kSeenEnough = 0.25;      // share of the object: with less a frame is no measure
constexpr double kBeside_px = 2.0;        // a mask's rim may be off by this before it is foreign
constexpr double kMoves_mm_s = 3.0;       // nominal, rms: with less it rests
constexpr double kLostBelow = 0.1;        // IoU
constexpr double kBlankSeen = 1.0 / 3.0;  // share of the object
constexpr std::size_t kBlankAfter = 5;    // frames after it came into view
constexpr double kWrongSignAbove_mm_s = 15.0;  // nominal
constexpr std::size_t kSettled = 24;           // frames: what is held is held by then

Workspace workspaceOf(const Recording& recording) {
  Workspace out;
  out.width_px = recording.info.width_px;
  out.height_px = recording.info.height_px;
  return out;
}

// A velocity of a point in space as it is in the picture, nominal mm/s.
Vec2 inPicture(const Recording& recording, const Vec3& p, const Vec3& v) {
  const double focal_px = recording.camera.fx_px;
  const Vec2 mm = workspaceOf(recording).mmPerPixel();
  const double z2 = p.z() * p.z();
  return {mm.x() * focal_px * (v.x() * p.z() - p.x() * v.z()) / z2,
          -mm.y() * focal_px * (v.y() * p.z() - p.y() * v.z()) / z2};
}

Vec2 trueVelocity(const Recording& recording, const MotionState& centre) {
  return inPicture(recording, centre.pose.at_mm, centre.velocity_mm_s);
}

// No object has no velocity.
Vec2 estimatedVelocity(const Run& run, std::size_t frame) {
  const auto& object = run.largest[frame];
  return object ? Vec2(object->motion.velocity_mm_s.head<2>()) : Vec2::Zero();
}

double quantile(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return double(values[static_cast<std::size_t>(at)]);
}

void scoreMasks(const Recording& recording, const Run& run, Scores& out) {
  for (std::size_t i = 0; i < run.masks.size(); ++i) {
    const Truth& truth = recording.truth[i];
    if (truth.visibleShare() < kSeenEnough) continue;
    const cv::Mat own = truth.mask();
    ++out.frames;
    const double iou = run.masks[i].empty() ? 0.0 : server::computeOverlap(run.masks[i], own);
    out.mean_iou += iou;
    out.worst_iou = std::min(out.worst_iou, iou);
    if (iou < kLostBelow) ++out.lost;
    if (run.masks[i].empty()) continue;
    cv::Mat distance;
    cv::distanceTransform(own == 0, distance, cv::DIST_L2, 5);
    const double foreign =
        cv::countNonZero(run.masks[i] & (distance > kBeside_px)) / double(cv::countNonZero(own));
    out.foreign += foreign;
    out.worst_foreign = std::max(out.worst_foreign, foreign);
  }
  out.mean_iou /= std::max(1.0, double(out.frames));
  out.foreign /= std::max(1.0, double(out.frames));
}

// From the first frame on it is in view since long.
void countBlankFrames(const Recording& recording, const Run& run, Scores& out) {
  std::size_t in_view = kBlankAfter;
  for (std::size_t i = 0; i < run.masks.size(); ++i) {
    const Truth& truth = recording.truth[i];
    if (truth.visibleShare() <= kBlankSeen) {
      in_view = 0;
      continue;
    }
    if (in_view++ < kBlankAfter) continue;
    if (run.masks[i].empty() || server::computeOverlap(run.masks[i], truth.mask()) < kLostBelow)
      ++out.blank;
  }
}

// The part of the announced heights between which the object's own pixels lie, over the clip, and
// how many of them reach beyond.
void scoreRelief(const Recording& recording, const Run& run, Scores& out) {
  std::vector<float> own;
  for (std::size_t i = 0; i < run.heights.size(); i += 2) {
    const cv::Mat mask = recording.truth[i].mask();
    for (int v = 0; v < mask.rows; v += 2) {
      for (int u = 0; u < mask.cols; u += 2) {
        const float height = run.heights[i].at<float>(v, u);
        if (mask.at<uchar>(v, u) != 0 && !std::isnan(height)) own.push_back(height);
      }
    }
  }
  const double top_mm = Workspace().depth_mm;
  const auto cut = std::count_if(own.begin(), own.end(), [top_mm](float height) {
    return height <= 0.0F || double(height) >= top_mm;
  });
  out.cut_share = double(cut) / std::max(1.0, double(own.size()));
  out.relief_share = (quantile(own, 0.99) - quantile(own, 0.01)) / top_mm;
}

double velocityError(const Recording& recording, const Run& run) {
  double errors = 0.0;
  double speeds = 0.0;
  for (std::size_t i = 0; i < run.largest.size(); ++i) {
    if (recording.truth[i].visibleShare() < kSeenEnough) continue;
    const Vec2 exact = trueVelocity(recording, recording.truth[i].centre);
    const Vec2 got = estimatedVelocity(run, i);
    errors += (got - exact).squaredNorm();
    speeds += exact.squaredNorm();
  }
  const double frames = std::max(1.0, double(run.largest.size()));
  return std::sqrt(speeds / frames) < kMoves_mm_s ? -1.0 : std::sqrt(errors / speeds);
}

// Regression of the estimated on the true velocity, along each axis. No object has no velocity.
void scoreVelocityGain(const Recording& recording, const Run& run, Scores& out) {
  Vec2 products = Vec2::Zero();
  Vec2 squares = Vec2::Zero();
  double frames = 0.0;
  double fast = 0.0;
  double wrong = 0.0;
  for (std::size_t i = 0; i < run.largest.size(); ++i) {
    if (recording.truth[i].visibleShare() < kSeenEnough) continue;
    const Vec2 exact = trueVelocity(recording, recording.truth[i].centre);
    const Vec2 got = estimatedVelocity(run, i);
    frames += 1.0;
    products += got.cwiseProduct(exact);
    squares += exact.cwiseProduct(exact);
    for (const Eigen::Index axis : {0, 1}) {
      if (std::abs(exact[axis]) <= kWrongSignAbove_mm_s) continue;
      fast += 1.0;
      if (got[axis] * exact[axis] < 0) wrong += 1.0;
    }
  }
  for (const Eigen::Index axis : {0, 1}) {
    if (std::sqrt(squares[axis] / std::max(1.0, frames)) > kMoves_mm_s)
      out.velocity_gain[axis] = products[axis] / squares[axis];
  }
  out.wrong_sign = wrong / std::max(1.0, fast);
}

// Sums of squares of what the object's own motion leaves of the surface's, without and with the
// grid, over one frame.
struct Left {
  double without = 0.0, with = 0.0;
};
Left leftBy(const Recording& recording, std::size_t frame, const HapticObject& object) {
  const Truth& truth = recording.truth[frame];
  const cv::Mat own = truth.mask();
  const Workspace workspace = workspaceOf(recording);
  const double t = recording.frames[frame].clip_time_s;
  const PixelRect& rect = object.relief->rect;
  Left out;
  for (int v = rect.v + kGridCell_px / 2; v < rect.v + rect.height; v += kGridCell_px) {
    for (int u = rect.u + kGridCell_px / 2; u < rect.u + rect.width; u += kGridCell_px) {
      if (own.at<uchar>(v, u) == 0) continue;
      const Vec3 at = double(truth.depth.at<float>(v, u)) * recording.camera.ray(u + 0.5, v + 0.5);
      const Vec2 exact = inPicture(recording, at, recording.object.velocityAt(at, t));
      const Vec2 off =
          workspace.toNominal({u + 0.5, v + 0.5}) - object.motion.position_mm.head<2>();
      const Vec2 turning = object.motion.angular_velocity_rad_s * Vec2(-off.y(), off.x());
      const Vec2 left = exact - object.motion.velocity_mm_s.head<2>() - turning;
      Vec2 sent = Vec2::Zero();
      if (object.grid) {
        const auto cell = static_cast<std::size_t>(
            ((v - rect.v) / kGridCell_px) * object.grid->columns + (u - rect.u) / kGridCell_px);
        sent = object.grid->velocity_mm_s[cell].head<2>().cast<double>();
      }
      out.without += left.squaredNorm();
      out.with += (left - sent).squaredNorm();
    }
  }
  return out;
}

double gridShare(const Recording& recording, const Run& run) {
  Left sum;
  for (std::size_t i = 0; i < run.largest.size(); ++i) {
    if (!run.largest[i] || recording.object.bent.rate(recording.frames[i].clip_time_s) == 0.0)
      continue;
    const Left left = leftBy(recording, i, *run.largest[i]);
    sum.without += left.without;
    sum.with += left.with;
  }
  return sum.without > 0 ? 1.0 - sum.with / sum.without : -1.0;
}

Vec2 middleOf_px(const Recording& recording, std::size_t frame) {
  return recording.camera.project(recording.truth[frame].centre.pose.at_mm);
}

// The pixels that carry another layer's name than they did, moved with the object, of those that
// are the object's in both frames.
double renamedShare(const Recording& recording, const Run& run) {
  double sum = 0.0;
  for (std::size_t i = 1; i < run.layers.size(); ++i) {
    const Vec2 moved_px = middleOf_px(recording, i) - middleOf_px(recording, i - 1);
    const cv::Matx23d shift{1, 0, std::round(moved_px.x()), 0, 1, std::round(moved_px.y())};
    cv::Mat last;
    cv::warpAffine(run.layers[i - 1], last, shift, last.size(), cv::INTER_NEAREST);
    const cv::Mat both = (last > 0) & (run.layers[i] > 0) & recording.truth[i].mask();
    const int renamed = cv::countNonZero(both & (last != run.layers[i]));
    sum += renamed / std::max(1.0, double(cv::countNonZero(both)));
  }
  return sum / std::max(1.0, double(run.layers.size()) - 1.0);
}

// Nothing of it moves, and nothing passes before it.
bool rests(const Recording& recording) {
  const cv::Mat first = recording.truth.front().mask();
  return std::all_of(recording.truth.begin(), recording.truth.end(), [&](const Truth& truth) {
    return cv::countNonZero(truth.mask() != first) == 0;
  });
}

}  // namespace

Scores scoresOf(const Recording& recording, const Run& run) {
  Scores out;
  scoreMasks(recording, run, out);
  countBlankFrames(recording, run, out);
  scoreVelocityGain(recording, run, out);
  if (!run.refused.empty()) return out;
  scoreRelief(recording, run, out);
  out.renamed = renamedShare(recording, run);
  out.velocity_error = velocityError(recording, run);
  out.grid_share = gridShare(recording, run);
  if (rests(recording) && run.heights.size() > kSettled)
    out.noise_N = forceNoise_N(run.heights, kSettled, run.heights.size(),
                               workspaceOf(recording).mmPerPixel().x());
  std::vector<double> ms(run.ms.begin() + std::min<std::ptrdiff_t>(1, std::ssize(run.ms)),
                         run.ms.end());
  std::sort(ms.begin(), ms.end());
  if (!ms.empty()) {
    out.median_ms = ms[ms.size() / 2];
    out.slow_ms = ms[ms.size() * 95 / 100];
  }
  return out;
}

}  // namespace hapticast::evaluate::held
