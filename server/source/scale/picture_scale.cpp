// SPDX-License-Identifier: MIT
#include "server/source/scale/picture_scale.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "common/haptic_frame.hpp"

namespace hapticast::server {

cv::Size fitSize(cv::Size own) {
  const double scale =
      std::min({1.0, double{kMaxWidth_px} / own.width, double{kMaxHeight_px} / own.height});
  const auto side_px = [scale](int own_px) {
    return std::max(1, static_cast<int>(std::lround(scale * own_px)));
  };
  return {side_px(own.width), side_px(own.height)};
}

void setSize(SourceInfo& info, cv::Size own, const std::string& place) {
  const cv::Size fitted = fitSize(own);
  info.width_px = fitted.width;
  info.height_px = fitted.height;
  info.own_px = {static_cast<double>(own.width) / fitted.width,
                 static_cast<double>(own.height) / fitted.height};
  if (fitted == own) return;
  spdlog::info("{}: pictures of {} x {} are scaled to {} x {}", place, own.width, own.height,
               fitted.width, fitted.height);
}

cv::Size frameSize(const SourceInfo& info) { return {info.width_px, info.height_px}; }

cv::Size ownSize(const SourceInfo& info) {
  return {static_cast<int>(std::lround(info.width_px * info.own_px.x())),
          static_cast<int>(std::lround(info.height_px * info.own_px.y()))};
}

cv::Mat scaleColor(const cv::Mat& color, cv::Size size) {
  if (color.size() == size) return color;
  cv::Mat scaled;
  cv::resize(color, scaled, size, 0.0, 0.0, cv::INTER_AREA);
  return scaled;
}

cv::Mat scaleMask(const cv::Mat& mask, cv::Size size) {
  if (mask.size() == size) return mask;
  cv::Mat scaled;
  cv::resize(mask, scaled, size, 0.0, 0.0, cv::INTER_NEAREST_EXACT);
  return scaled;
}

CameraModel scaleCamera(const CameraModel& camera, const SourceInfo& info) {
  return {camera.fx_px / info.own_px.x(), camera.fy_px / info.own_px.y(),
          camera.cx_px / info.own_px.x(), camera.cy_px / info.own_px.y()};
}

}  // namespace hapticast::server
