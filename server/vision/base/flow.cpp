// SPDX-License-Identifier: MIT
#include "server/vision/base/flow.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr int kCorners = 120;             // chosen: a prototype's 90 and some spare ones
constexpr int kFewestTracks = 5;          // chosen: two and a half times what a similarity needs
constexpr int kFewestForRotation = 12;    // chosen: three times what a similarity needs
constexpr int kWindow_px = 15;            // chosen, of Lucas-Kanade
constexpr double kThereAndBack_px = 1.0;  // chosen, these three, with a prototype on real clips
constexpr double kInlier_px = 2.0;
constexpr std::size_t kRansacRounds = 500;
// Chosen: a larger change of scale between frames means that the tracks slipped.
constexpr double kSmallestScale = 0.85;
constexpr double kLargestScale = 1.18;

std::vector<cv::Point2f> translate(std::vector<cv::Point2f> points, const cv::Point2f& by) {
  for (cv::Point2f& point : points) point += by;
  return points;
}

cv::Vec2d medianShift(const PointTracks& tracks) {
  std::vector<double> u;
  std::vector<double> v;
  for (std::size_t i = 0; i < tracks.from.size(); ++i) {
    u.push_back(static_cast<double>(tracks.to[i].x - tracks.from[i].x));
    v.push_back(static_cast<double>(tracks.to[i].y - tracks.from[i].y));
  }
  return {computeMedian(u), computeMedian(v)};
}

PointTracks selectInliers(const PointTracks& tracks, const cv::Mat& inliers) {
  PointTracks out;
  for (std::size_t i = 0; i < tracks.from.size(); ++i) {
    if (inliers.at<unsigned char>(static_cast<int>(i)) == 0) continue;
    out.from.push_back(tracks.from[i]);
    out.to.push_back(tracks.to[i]);
  }
  return out;
}

void fitMotion(ObjectFlow& flow) {
  const std::size_t found = flow.tracks.from.size();
  if (found < 3) return;
  const cv::Vec2d shift = medianShift(flow.tracks);
  flow.similarity = {1, 0, shift[0], 0, 1, shift[1]};
  flow.reliable = found >= kFewestTracks;
  if (!flow.reliable) return;
  cv::Mat inliers;
  const cv::Mat fit = cv::estimateAffinePartial2D(flow.tracks.from, flow.tracks.to, inliers,
                                                  cv::RANSAC, kInlier_px, kRansacRounds, 0.99, 10);
  if (fit.empty()) return;
  const int agree = cv::countNonZero(inliers);
  const cv::Matx23d matrix(fit);
  const double scale = std::hypot(matrix(0, 0), matrix(1, 0));
  if (scale < kSmallestScale || scale > kLargestScale || agree < kFewestTracks) return;
  flow.similarity = matrix;
  flow.rotation_reliable = agree >= kFewestForRotation && 2 * agree > static_cast<int>(found);
  flow.tracks = selectInliers(flow.tracks, inliers);
}

std::vector<cv::Point2f> findCorners(const cv::Mat& gray, const cv::Mat& mask) {
  cv::Mat inner = erodeBy(mask, 2);
  if (cv::countNonZero(inner) < 100) inner = mask;
  cv::Mat picture = gray;
  const float scale = findBoxAround(mask, 0).area() > kDense_px ? 2.0F : 1.0F;
  if (scale > 1.0F) {
    const cv::Size half(gray.cols / 2, gray.rows / 2);
    cv::resize(gray, picture, half, 0, 0, cv::INTER_AREA);
    cv::resize(inner, inner, half, 0, 0, cv::INTER_NEAREST);
  }
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(picture, corners, kCorners, 0.01, 4.0 / double(scale), inner);
  const float middle = 0.5F * (scale - 1.0F);  // centre of the pixels that were merged
  for (cv::Point2f& corner : corners) corner = scale * corner + cv::Point2f(middle, middle);
  return corners;
}

}  // namespace

cv::Point2d ObjectFlow::warp(const cv::Point2d& point) const {
  const cv::Vec2d out = similarity * cv::Vec3d(point.x, point.y, 1.0);
  return {out[0], out[1]};
}
double ObjectFlow::scale() const { return std::hypot(similarity(0, 0), similarity(1, 0)); }
double ObjectFlow::rotation_rad() const { return std::atan2(similarity(1, 0), similarity(0, 0)); }

PointTracks trackPoints(const cv::Mat& last_gray, const cv::Mat& gray,
                        const std::vector<cv::Point2f>& points, std::vector<cv::Point2f> forward) {
  PointTracks out;
  if (points.empty()) return out;
  const cv::Size window(kWindow_px, kWindow_px);
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.005);
  std::vector<cv::Point2f> back(points);
  std::vector<unsigned char> found;
  std::vector<unsigned char> found_back;
  std::vector<float> error;
  std::vector<cv::Mat> last_pyramid;
  std::vector<cv::Mat> pyramid;
  const int levels = cv::buildOpticalFlowPyramid(last_gray, last_pyramid, window, 3);
  cv::buildOpticalFlowPyramid(gray, pyramid, window, 3);
  cv::calcOpticalFlowPyrLK(last_pyramid, pyramid, points, forward, found, error, window, levels,
                           until, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  // The way back is only compared with kThereAndBack_px.
  const cv::TermCriteria roughly(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.03);
  cv::calcOpticalFlowPyrLK(pyramid, last_pyramid, forward, back, found_back, error, window, levels,
                           roughly, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  const cv::Rect2f inside(0, 0, static_cast<float>(gray.cols - 1),
                          static_cast<float>(gray.rows - 1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i] == 0 || found_back[i] == 0 || !inside.contains(forward[i])) continue;
    if (cv::norm(back[i] - points[i]) >= kThereAndBack_px) continue;
    out.from.push_back(points[i]);
    out.to.push_back(forward[i]);
  }
  return out;
}

ObjectFlow trackObject(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& mask,
                       const cv::Vec2d& guess_px) {
  ObjectFlow flow;
  flow.similarity = {1, 0, guess_px[0], 0, 1, guess_px[1]};
  const int reach = 48 + static_cast<int>(std::min(1000.0, cv::norm(guess_px)));
  const cv::Rect box = findBoxAround(mask, reach);
  if (box.empty()) return flow;
  const std::vector<cv::Point2f> corners = findCorners(last_gray(box), mask(box));
  if (corners.empty()) return flow;
  const cv::Mat last = last_gray(box);
  const cv::Mat now = gray(box);
  const cv::Point2f guess(static_cast<float>(guess_px[0]), static_cast<float>(guess_px[1]));
  flow.tracks = trackPoints(last, now, corners, translate(corners, guess));
  if (2 * flow.tracks.from.size() < corners.size() && cv::norm(guess_px) > 1.0) {
    // After a bounce the guess points in the wrong direction.
    const PointTracks still = trackPoints(last, now, corners, corners);
    if (still.from.size() > flow.tracks.from.size()) {
      flow.similarity = {1, 0, 0, 0, 1, 0};
      flow.tracks = still;
    }
  }
  const cv::Point2f corner(static_cast<float>(box.x), static_cast<float>(box.y));
  flow.tracks = {translate(flow.tracks.from, corner), translate(flow.tracks.to, corner)};
  fitMotion(flow);
  return flow;
}

cv::Mat warpImage(const cv::Mat& image, const cv::Rect& from_box, const cv::Rect& to_box,
                  const cv::Matx23d& similarity, int interpolation) {
  cv::Matx23d local = similarity;
  local(0, 2) += similarity(0, 0) * from_box.x + similarity(0, 1) * from_box.y - to_box.x;
  local(1, 2) += similarity(1, 0) * from_box.x + similarity(1, 1) * from_box.y - to_box.y;
  cv::Mat out;
  cv::warpAffine(image, out, local, to_box.size(), interpolation, cv::BORDER_CONSTANT,
                 cv::Scalar(0));
  return out;
}

cv::Matx33d homogeneous(const cv::Matx23d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), 0, 0, 1};
}

}  // namespace hapticast::server
