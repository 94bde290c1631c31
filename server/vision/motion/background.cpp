// SPDX-License-Identifier: MIT
#include "server/vision/motion/background.hpp"

#include <opencv2/imgproc.hpp>
#include <utility>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

constexpr int kBesideObjects_px = 4;   // chosen, at half size: mixed pixels at the rims of objects
constexpr double kStanding_px = 0.03;  // measured on a camera at rest: smaller steps are noise

}  // namespace

std::vector<cv::Vec2d> BackgroundMotion::next(const cv::Mat& gray,
                                              const std::vector<Object>& objects) {
  std::vector<cv::Vec2d> steps_px(objects.size(), {0, 0});
  cv::Mat small;
  cv::resize(gray, small, {}, 0.5, 0.5, cv::INTER_AREA);
  const cv::Mat last = std::exchange(last_small_, small);
  if (last.empty() || objects.empty()) return steps_px;
  cv::Mat background(gray.size(), CV_8UC1, cv::Scalar(255));
  for (const Object& object : objects) background.setTo(0, object.mask);
  cv::resize(background, background, last.size(), 0, 0, cv::INTER_NEAREST);
  const ObjectFlow flow =
      trackObject(last, small, erodeBy(background, kBesideObjects_px), 0.5 * last_step_px_);
  if (!flow.reliable) return steps_px;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const cv::Point2d at = 0.5 * objects[i].at_px;
    const cv::Point2d step = 2.0 * (flow.warp(at) - at);
    last_step_px_ = {step.x, step.y};
    if (cv::norm(step) > kStanding_px) steps_px[i] = last_step_px_;
  }
  return steps_px;
}

}  // namespace hapticast::server
