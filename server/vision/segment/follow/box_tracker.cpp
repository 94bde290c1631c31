// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/box_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr double kBox_px =
    48.0;  // chosen for time: width of a box of this area in the reduced picture

cv::Rect scaleBox(const cv::Rect& box, double factor) {
  return {static_cast<int>(std::lround(factor * box.x)),
          static_cast<int>(std::lround(factor * box.y)),
          std::max(1, static_cast<int>(std::lround(factor * box.width))),
          std::max(1, static_cast<int>(std::lround(factor * box.height)))};
}

}  // namespace

BoxTracker::BoxTracker(const cv::Mat& color, const cv::Rect& box)
    : shrink_(std::min(1.0, kBox_px / std::sqrt(std::max(1, box.area())))),
      filter_(cv::TrackerCSRT::create()) {
  cv::setRNGSeed(7);
  filter_->init(shrinkPicture(color), scaleBox(box, shrink_));
}

std::optional<cv::Rect> BoxTracker::next(const cv::Mat& color) {
  cv::Rect box;
  if (!filter_->update(shrinkPicture(color), box)) return std::nullopt;
  const cv::Rect found = scaleBox(box, 1.0 / shrink_) & cv::Rect({0, 0}, color.size());
  if (found.width < kSmallestBox_px || found.height < kSmallestBox_px) return std::nullopt;
  return found;
}

cv::Mat BoxTracker::shrinkPicture(const cv::Mat& color) const {
  if (shrink_ == 1.0) return color;
  cv::Mat out;
  cv::resize(color, out, {}, shrink_, shrink_, cv::INTER_AREA);
  return out;
}

}  // namespace hapticast::server
