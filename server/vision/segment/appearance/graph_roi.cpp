// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/graph_roi.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr double kUsualFocal = 0.94;  // relative to the width: field of view of most cameras

}  // namespace

double pixelsPerMm(double depth_mm, const cv::Size& picture) {
  return kUsualFocal * picture.width / std::max(depth_mm, 1.0);
}

GraphRoi GraphRoi::around(const FrameContext& scene, const cv::Rect& box, double most_px) {
  GraphRoi out;
  out.box = box;
  out.shrink = std::min(1.0, std::sqrt(most_px / std::max(1, box.area())));
  const cv::Size size(std::max(1, int(std::lround(box.width * out.shrink))),
                      std::max(1, int(std::lround(box.height * out.shrink))));
  cv::resize(scene.images.color(box), out.color, size, 0, 0, cv::INTER_AREA);
  cv::resize(scene.images.depth(box), out.depth, size, 0, 0, cv::INTER_NEAREST);
  const cv::Mat plane = onPlanes(scene.images.depth, box, scene.planes);
  cv::resize(plane, out.plane, size, 0, 0, cv::INTER_NEAREST);
  const int factor = std::max(1, scene.images.color.cols / kUsualWidth_px);
  cv::Mat usual;
  cv::resize(scene.images.color(box), usual, {}, 1.0 / factor, 1.0 / factor, cv::INTER_AREA);
  cv::resize(scene.skin.in(usual), out.skin, size, 0, 0, cv::INTER_NEAREST);
  out.color.convertTo(out.lab, CV_32F, 1.0 / 255.0);
  cv::cvtColor(out.lab, out.lab, cv::COLOR_BGR2Lab);
  return out;
}

cv::Mat GraphRoi::shrunk(const cv::Mat& mask) const {
  cv::Mat out;
  cv::resize(mask(box), out, size(), 0, 0, cv::INTER_AREA);
  return out > 127;
}

cv::Mat GraphRoi::inPicture(const cv::Mat& mask, const cv::Size& picture) const {
  cv::Mat large;
  cv::resize(mask, large, box.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out = cv::Mat::zeros(picture, CV_8UC1);
  cv::Mat(large > 127).copyTo(out(box));
  return out;
}

cv::Point GraphRoi::toRoi(const cv::Point& at) const {
  const cv::Size small = size();
  return {std::clamp(int((at.x - box.x + 0.5) * small.width / box.width), 0, small.width - 1),
          std::clamp(int((at.y - box.y + 0.5) * small.height / box.height), 0, small.height - 1)};
}

}  // namespace hapticast::server
