// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/motion_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

constexpr int kFromMask_px = 3;    // chosen: corners nearer to the contour mix both motions
constexpr int kRingWidth_px = 24;  // chosen: an arm beside the object, not the room
constexpr int kRingCorners = 60;   // chosen for time
constexpr int kFewestAgree = 8;    // chosen: twice what a similarity needs, and as many again
constexpr double kAgree_px = 1.0;
// Chosen: motions that differ less at a pixel do not tell objects apart.
constexpr double kApart_px = 1.5;
constexpr double kGreyNoise = 4.0;  // chosen, of 255: residuals below it are noise
constexpr int kResidualWindow_px = 5;

// Returns the mean difference of this picture and the last one moved by `similarity`.
cv::Mat computeResidual(const ObjectRoi& patch, const cv::Mat& last_gray,
                        const cv::Matx23d& similarity) {
  const cv::Rect whole({0, 0}, last_gray.size());
  cv::Mat moved = warpImage(last_gray, whole, patch.box, similarity, cv::INTER_LINEAR);
  cv::absdiff(moved, patch.gray, moved);
  cv::Mat out;
  cv::boxFilter(moved, out, CV_32F, {kResidualWindow_px, kResidualWindow_px});
  return out;
}

}  // namespace

std::optional<OtherMotion> findOtherMotion(const cv::Mat& last_gray, const cv::Mat& gray,
                                           const cv::Mat& mask, const ObjectFlow& flow) {
  const cv::Rect box = findBoxAround(mask, kFromMask_px + kRingWidth_px);
  if (box.empty() || !flow.reliable) return std::nullopt;
  const cv::Mat ring =
      dilateBy(mask(box), kFromMask_px + kRingWidth_px) & ~dilateBy(mask(box), kFromMask_px);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(last_gray(box), corners, kRingCorners, 0.02, 6.0, ring);
  if (corners.size() < kFewestAgree) return std::nullopt;
  const cv::Rect wide = growRect(box, 32, gray.size());
  const cv::Point2f corner(static_cast<float>(box.x - wide.x), static_cast<float>(box.y - wide.y));
  for (cv::Point2f& each : corners) each += corner;
  const PointTracks tracks = trackPoints(last_gray(wide), gray(wide), corners, corners);
  PointTracks others;
  for (std::size_t i = 0; i < tracks.from.size(); ++i) {
    const cv::Point2f from = tracks.from[i] + cv::Point2f(wide.tl());
    const cv::Point2f to = tracks.to[i] + cv::Point2f(wide.tl());
    if (cv::norm(flow.warp(from) - cv::Point2d(to)) < kApart_px) continue;
    others.from.push_back(from);
    others.to.push_back(to);
  }
  if (others.from.size() < kFewestAgree) return std::nullopt;
  cv::Mat inliers;
  const cv::Mat fit = cv::estimateAffinePartial2D(others.from, others.to, inliers, cv::RANSAC,
                                                  kAgree_px, 200, 0.99, 5);
  if (fit.empty() || cv::countNonZero(inliers) < kFewestAgree) return std::nullopt;
  return OtherMotion{last_gray, cv::Matx23d(fit)};
}

cv::Mat computeMotionEvidence(const ObjectRoi& patch, const OtherMotion& other,
                              const cv::Matx23d& own) {
  const cv::Mat by_own = computeResidual(patch, other.last_gray, own);
  const cv::Mat by_other = computeResidual(patch, other.last_gray, other.similarity);
  cv::Mat full(patch.gray.size(), CV_32FC1);
  for (int v = 0; v < full.rows; ++v) {
    const auto* a = by_own.ptr<float>(v);
    const auto* b = by_other.ptr<float>(v);
    auto* to = full.ptr<float>(v);
    for (int u = 0; u < full.cols; ++u)
      to[u] = (b[u] - a[u]) / (static_cast<float>(kGreyNoise) + a[u] + b[u]);
  }
  cv::Mat out;
  cv::resize(full, out, patch.depth.size(), 0, 0, cv::INTER_AREA);
  const cv::Matx23d difference = own - other.similarity;
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      const cv::Vec3d at(patch.pictureU(u), patch.pictureV(v), 1.0);
      if (cv::norm(difference * at) < kApart_px) out.at<float>(v, u) = 0.0F;
    }
  }
  return out;
}

}  // namespace hapticast::server
