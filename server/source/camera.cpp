// SPDX-License-Identifier: MIT
#include "server/source/camera.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>

namespace hapticast::server {

namespace {

std::string deviceName(int number) { return "/dev/video" + std::to_string(number); }

void openDevice(cv::VideoCapture& capture, int number, double fps) {
  const std::string name = deviceName(number);
  std::error_code error;
  if (!std::filesystem::exists(name, error)) {
    throw SourceError(name + ": no such camera; see /dev/video* for those there are");
  }
  if (!capture.open(number, cv::CAP_V4L2)) {
    throw SourceError(name +
                      ": cannot be opened; is it used by another program, or access denied?");
  }
  if (fps > 0.0) capture.set(cv::CAP_PROP_FPS, fps);
}

cv::Mat firstPicture(cv::VideoCapture& capture, const std::string& name) {
  cv::Mat frame;
  if (!capture.read(frame) || frame.empty()) {
    throw SourceError(name + ": gives no picture; is it a camera that captures?");
  }
  if (!sizeAllowed(frame.cols, frame.rows)) {
    throw SourceError(name + ": gives " + sizeText(frame.cols, frame.rows) +
                      "; allowed is up to 1920x1080, so set a smaller format");
  }
  return frame;
}

DepthKind kindOf(const cv::Mat& raw, const std::string& name) {
  if (raw.type() == CV_16UC1) return DepthKind::kMetric;
  if (raw.type() == CV_8UC1 || (raw.type() == CV_8UC3 && !isColorCoded(raw))) {
    return DepthKind::kHeight;
  }
  throw SourceError(name +
                    ": gives no depth (neither 16-bit nor grey pictures); choose the depth camera");
}

}  // namespace

Camera::Camera(int color, int depth, double fps)
    : color_name_(deviceName(color)), depth_name_(deviceName(depth)) {
  openDevice(color_, color, fps);
  openDevice(depth_, depth, fps);
  // Otherwise 16-bit depth would be squeezed into 8 bits.
  depth_.set(cv::CAP_PROP_CONVERT_RGB, 0.0);
  const cv::Mat picture = firstPicture(color_, color_name_);
  const cv::Mat raw = firstPicture(depth_, depth_name_);
  format_.kind = kindOf(raw, depth_name_);
  if (picture.type() != CV_8UC3)
    throw SourceError(color_name_ + ": gives no colour; choose another camera");
  if (raw.size() != picture.size()) {
    throw SourceError(depth_name_ + ": gives " + sizeText(raw.cols, raw.rows) + ", but " +
                      color_name_ + " " + sizeText(picture.cols, picture.rows) +
                      "; set both to the same format");
  }
  const double claimed = color_.get(cv::CAP_PROP_FPS);
  info_.name = "camera:" + std::to_string(color) + "," + std::to_string(depth);
  info_.width_px = picture.cols;
  info_.height_px = picture.rows;
  info_.fps = fps > 0.0 ? fps : (claimed >= 1.0 && claimed <= 240.0 ? claimed : 25.0);
  info_.depth_kind = format_.kind;
  info_.live = true;
}

void Camera::grab() {
  const bool color = color_.grab();
  if (color && depth_.grab()) {
    ++next_;
    return;
  }
  throw SourceError((color ? depth_name_ : color_name_) +
                    ": gives no more pictures; is it still plugged in?");
}

std::optional<RgbdFrame> Camera::read() {
  const cv::Size size(info_.width_px, info_.height_px);
  for (;;) {
    grab();
    RgbdFrame frame;
    frame.index = next_ - 1;
    frame.clip_time_s = static_cast<double>(frame.index) / info_.fps;
    cv::Mat color;
    cv::Mat raw;
    if (color_.retrieve(color) && depth_.retrieve(raw) && color.size() == size &&
        raw.size() == size) {
      ImageResult depth = toDepth(raw, format_);
      frame.color = color.clone();
      frame.depth = depth.image;
      if (depth.ok()) return frame;
    }
    spdlog::warn("{}: frame {} cannot be decoded; it is left out", info_.name, frame.index);
  }
}

bool Camera::skip() {
  grab();
  return true;
}

void Camera::rewind() { throw SourceError(info_.name + ": is live and cannot be rewound"); }

}  // namespace hapticast::server
