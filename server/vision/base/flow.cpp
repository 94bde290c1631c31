// SPDX-License-Identifier: MIT
#include "server/vision/base/flow.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "server/vision/base/view.hpp"

namespace hapticast::server {

namespace {

constexpr int kCorners = 120;
constexpr int kFewestTracks = 5;
constexpr int kFewestForRotation = 12;

cv::Vec2d medianShift(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& to) {
  std::vector<double> u;
  std::vector<double> v;
  for (std::size_t i = 0; i < from.size(); ++i) {
    u.push_back(static_cast<double>(to[i].x - from[i].x));
    v.push_back(static_cast<double>(to[i].y - from[i].y));
  }
  return {medianOf(u), medianOf(v)};
}

void keepInliers(ObjectFlow& flow, const cv::Mat& inliers) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < flow.from.size(); ++i) {
    if (inliers.at<unsigned char>(static_cast<int>(i)) == 0) continue;
    flow.from[kept] = flow.from[i];
    flow.to[kept] = flow.to[i];
    ++kept;
  }
  flow.from.resize(kept);
  flow.to.resize(kept);
}

void fitMotion(ObjectFlow& flow) {
  const std::size_t found = flow.from.size();
  if (found < 3) return;
  const cv::Vec2d shift = medianShift(flow.from, flow.to);
  flow.similarity = {1, 0, shift[0], 0, 1, shift[1]};
  flow.reliable = found >= kFewestTracks;
  if (!flow.reliable) return;
  cv::Mat inliers;
  const cv::Mat fit =
      cv::estimateAffinePartial2D(flow.from, flow.to, inliers, cv::RANSAC, 2.0, 500, 0.99, 10);
  if (fit.empty()) return;
  const int agree = cv::countNonZero(inliers);
  const cv::Matx23d matrix(fit);
  const double scale = std::hypot(matrix(0, 0), matrix(1, 0));
  if (scale < 0.85 || scale > 1.18 || agree < kFewestTracks) return;
  flow.similarity = matrix;
  flow.rotation_reliable = agree >= kFewestForRotation && 2 * agree > static_cast<int>(found);
  keepInliers(flow, inliers);
}

std::vector<cv::Point2f> cornersOf(const cv::Mat& gray, const cv::Mat& mask) {
  cv::Mat inner = erodedBy(mask, 2);
  if (cv::countNonZero(inner) < 100) inner = mask;
  cv::Mat picture = gray;
  const float scale = boxAround(mask, 0).area() > kDense_px ? 2.0F : 1.0F;
  if (scale > 1.0F) {
    const cv::Size half(gray.cols / 2, gray.rows / 2);
    cv::resize(gray, picture, half, 0, 0, cv::INTER_AREA);
    cv::resize(inner, inner, half, 0, 0, cv::INTER_NEAREST);
  }
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(picture, corners, kCorners, 0.01, 4.0 / double(scale), inner);
  const float middle = 0.5F * (scale - 1.0F);  // of the pixels that became one
  for (cv::Point2f& corner : corners) corner = scale * corner + cv::Point2f(middle, middle);
  return corners;
}

}  // namespace

cv::Point2d ObjectFlow::carry(const cv::Point2d& point) const {
  const cv::Vec2d out = similarity * cv::Vec3d(point.x, point.y, 1.0);
  return {out[0], out[1]};
}
double ObjectFlow::scale() const { return std::hypot(similarity(0, 0), similarity(1, 0)); }
double ObjectFlow::rotation_rad() const { return std::atan2(similarity(1, 0), similarity(0, 0)); }

void trackPoints(const cv::Mat& last_gray, const cv::Mat& gray,
                 const std::vector<cv::Point2f>& points, const cv::Vec2d& guess_px,
                 std::vector<cv::Point2f>& from, std::vector<cv::Point2f>& to) {
  std::vector<cv::Point2f> guesses(points);
  const cv::Point2f guess(static_cast<float>(guess_px[0]), static_cast<float>(guess_px[1]));
  for (cv::Point2f& point : guesses) point += guess;
  trackPoints(last_gray, gray, points, std::move(guesses), from, to);
}

void trackPoints(const cv::Mat& last_gray, const cv::Mat& gray,
                 const std::vector<cv::Point2f>& points, std::vector<cv::Point2f> forward,
                 std::vector<cv::Point2f>& from, std::vector<cv::Point2f>& to) {
  from.clear();
  to.clear();
  if (points.empty()) return;
  const cv::Size window(15, 15);
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
  cv::calcOpticalFlowPyrLK(pyramid, last_pyramid, forward, back, found_back, error, window, levels,
                           until, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  const cv::Rect2f inside(0, 0, static_cast<float>(gray.cols - 1),
                          static_cast<float>(gray.rows - 1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i] == 0 || found_back[i] == 0 || !inside.contains(forward[i])) continue;
    if (cv::norm(back[i] - points[i]) >= 1.0) continue;
    from.push_back(points[i]);
    to.push_back(forward[i]);
  }
}

ObjectFlow trackObject(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& mask,
                       const cv::Vec2d& guess_px) {
  ObjectFlow flow;
  flow.similarity = {1, 0, guess_px[0], 0, 1, guess_px[1]};
  const int reach = 48 + static_cast<int>(std::min(1000.0, cv::norm(guess_px)));
  const cv::Rect box = boxAround(mask, reach);
  if (box.empty()) return flow;
  const std::vector<cv::Point2f> corners = cornersOf(last_gray(box), mask(box));
  if (corners.empty()) return flow;
  trackPoints(last_gray(box), gray(box), corners, guess_px, flow.from, flow.to);
  if (2 * flow.from.size() < corners.size() && cv::norm(guess_px) > 1.0) {
    ObjectFlow still;  // a bounce turns the guess into the wrong one
    trackPoints(last_gray(box), gray(box), corners, {0.0, 0.0}, still.from, still.to);
    if (still.from.size() > flow.from.size()) flow = still;
  }
  const cv::Point2f corner(static_cast<float>(box.x), static_cast<float>(box.y));
  for (cv::Point2f& point : flow.from) point += corner;
  for (cv::Point2f& point : flow.to) point += corner;
  fitMotion(flow);
  return flow;
}

cv::Mat carryImage(const cv::Mat& image, const cv::Rect& from_box, const cv::Rect& to_box,
                   const cv::Matx23d& similarity, int interpolation) {
  cv::Matx23d local = similarity;
  local(0, 2) += similarity(0, 0) * from_box.x + similarity(0, 1) * from_box.y - to_box.x;
  local(1, 2) += similarity(1, 0) * from_box.x + similarity(1, 1) * from_box.y - to_box.y;
  cv::Mat out;
  cv::warpAffine(image, out, local, to_box.size(), interpolation, cv::BORDER_CONSTANT,
                 cv::Scalar(0));
  return out;
}

cv::Mat carryMask(const cv::Mat& mask, const cv::Matx23d& similarity) {
  cv::Mat out = cv::Mat::zeros(mask.size(), CV_8UC1);
  const cv::Rect from = boxAround(mask, 1);
  if (from.empty()) return out;
  std::vector<cv::Point2d> corners;
  for (const cv::Point& at :
       {from.tl(), from.br(), cv::Point(from.x, from.br().y), cv::Point(from.br().x, from.y)}) {
    const cv::Vec2d to = similarity * cv::Vec3d(at.x, at.y, 1.0);
    corners.emplace_back(to[0], to[1]);
  }
  const auto [left, right] = std::minmax_element(
      corners.begin(), corners.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  const auto [top, bottom] = std::minmax_element(
      corners.begin(), corners.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  const cv::Rect whole({0, 0}, mask.size());
  const cv::Rect to = cv::Rect(cv::Point(cvFloor(left->x) - 1, cvFloor(top->y) - 1),
                               cv::Point(cvCeil(right->x) + 2, cvCeil(bottom->y) + 2)) &
                      whole;
  if (to.empty()) return out;
  const cv::Mat moved = carryImage(mask(from), from, to, similarity, cv::INTER_LINEAR) > 127;
  moved.copyTo(out(to));
  return out;
}

}  // namespace hapticast::server
