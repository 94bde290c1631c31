// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/box_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

// Chosen for time: width of a square of the box's area in the reduced picture.
constexpr double kBox_px = 48.0;
// Chosen, in the reduced picture. OpenCV's filter throws if its smallest scale of a box is below a
// pixel, or if a box is so long that it leaves the template.
constexpr int kSmallestBox_px = 10;
constexpr int kLongestBox = 6;  // times its width

bool canFollow(const cv::Rect& box) {
  const int least_px = std::min(box.width, box.height);
  return least_px >= kSmallestBox_px && std::max(box.width, box.height) <= kLongestBox * least_px;
}

cv::Rect scaleBox(const cv::Rect& box, double factor) {
  const auto scale = [factor](int px) { return static_cast<int>(std::lround(factor * px)); };
  return {scale(box.x), scale(box.y), scale(box.width), scale(box.height)};
}

}  // namespace

BoxTracker::BoxTracker(const cv::Mat& color, const cv::Rect& box)
    : shrink_(std::min(1.0, kBox_px / std::sqrt(std::max(1, box.area())))) {
  const cv::Rect small = scaleBox(box, shrink_);
  if (!canFollow(small)) return;
  filter_ = cv::TrackerCSRT::create();
  try {
    filter_->init(shrinkPicture(color), small);
  } catch (const cv::Exception&) {
    filter_.release();
  }
}

std::optional<cv::Rect> BoxTracker::next(const cv::Mat& color) {
  cv::Rect small;
  bool found = false;
  try {
    found = filter_ != nullptr && filter_->update(shrinkPicture(color), small);
  } catch (const cv::Exception&) {  // a box that has shrunk or left the picture
  }
  const cv::Rect box = scaleBox(small, 1.0 / shrink_) & cv::Rect({0, 0}, color.size());
  if (found && canFollow(small) && !box.empty()) return box;
  filter_.release();
  return std::nullopt;
}

cv::Mat BoxTracker::shrinkPicture(const cv::Mat& color) const {
  if (shrink_ == 1.0) return color;
  cv::Mat out;
  cv::resize(color, out, {}, shrink_, shrink_, cv::INTER_AREA);
  return out;
}

}  // namespace hapticast::server
