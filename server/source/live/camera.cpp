// SPDX-License-Identifier: MIT
#include "server/source/live/camera.hpp"

#include <spdlog/spdlog.h>

#include <bit>
#include <filesystem>
#include <utility>

namespace hapticast::server {

namespace {

std::string deviceName(int number) { return "/dev/video" + std::to_string(number); }

constexpr int kMostBad = 25;  // chosen, frames in a row: about a second

std::unique_ptr<cv::VideoCapture> openDevice(int number, double fps) {
  const std::string name = deviceName(number);
  std::error_code error;
  if (!std::filesystem::exists(name, error)) {
    throw SourceError(name + ": no such camera; the cameras of this machine are /dev/video*");
  }
  auto capture = std::make_unique<cv::VideoCapture>();
  if (!capture->open(number, cv::CAP_V4L2)) {
    throw SourceError(name +
                      ": cannot be opened; is it used by another program, or access denied?");
  }
  if (fps > 0.0) capture->set(cv::CAP_PROP_FPS, fps);
  return capture;
}

cv::Mat firstPicture(cv::VideoCapture& capture, const std::string& name) {
  cv::Mat frame;
  if (!capture.read(frame) || frame.empty()) {
    throw SourceError(name + ": delivers no picture; is it a camera that captures?");
  }
  if (!sizeAllowed(frame.cols, frame.rows)) {
    throw SourceError(name + ": delivers " + sizeText(frame.cols, frame.rows) +
                      "; allowed is up to 1920x1080, so set a smaller format");
  }
  return frame;
}

DepthKind detectDepthKind(const cv::Mat& raw, const std::string& name) {
  if (raw.type() == CV_16UC1) return DepthKind::kMetric;
  if (raw.type() == CV_8UC1 || (raw.type() == CV_8UC3 && !isColorCoded(raw))) {
    return DepthKind::kHeight;
  }
  throw SourceError(
      name + ": delivers no depth (neither 16-bit nor grey pictures); choose the depth camera");
}

}  // namespace

// Braces guarantee the order: the colour camera opens first.
Camera::Camera(int color, int depth, double fps)
    : Camera{CameraDevice{openDevice(color, fps), deviceName(color)},
             CameraDevice{openDevice(depth, fps), deviceName(depth)}, fps} {
  info_.name = "camera:" + std::to_string(color) + "," + std::to_string(depth);
}

Camera::Camera(CameraDevice color, CameraDevice depth, double fps)
    : color_(std::move(color)), depth_(std::move(depth)) {
  // Otherwise OpenCV converts 16-bit depth to 8 bits.
  depth_.capture->set(cv::CAP_PROP_CONVERT_RGB, 0.0);
  const cv::Mat picture = firstPicture(*color_.capture, color_.name);
  const cv::Mat raw = firstPicture(*depth_.capture, depth_.name);
  format_.kind = detectDepthKind(raw, depth_.name);
  if (picture.type() != CV_8UC3)
    throw SourceError(color_.name + ": delivers no colour; choose another camera");
  if (raw.size() != picture.size()) {
    throw SourceError(depth_.name + ": delivers " + sizeText(raw.cols, raw.rows) + ", but " +
                      color_.name + " " + sizeText(picture.cols, picture.rows) +
                      "; set both to the same format");
  }
  const double claimed = color_.capture->get(cv::CAP_PROP_FPS);
  info_.name = color_.name + "," + depth_.name;
  info_.width_px = picture.cols;
  info_.height_px = picture.rows;
  info_.fps = fps > 0.0 ? fps : (claimed >= 1.0 && claimed <= 240.0 ? claimed : 25.0);
  info_.depth_kind = format_.kind;
  info_.live = true;
}

void Camera::grab() {
  const bool color = color_.capture->grab();
  if (color && depth_.capture->grab()) {
    ++next_;
    return;
  }
  throw SourceError((color ? depth_.name : color_.name) +
                    ": delivers no more pictures; is it still plugged in?");
}

std::string Camera::retrieve(const CameraDevice& device, cv::Mat& picture) const {
  if (!device.capture->retrieve(picture) || picture.empty())
    return device.name + ": delivers pictures that cannot be decoded";
  if (picture.size() == cv::Size(info_.width_px, info_.height_px)) return "";
  return device.name + ": delivers " + sizeText(picture.cols, picture.rows) + ", but began with " +
         sizeText(info_.width_px, info_.height_px);
}

std::optional<RgbdFrame> Camera::read() {
  std::string problem;
  for (int bad = 0; bad < kMostBad; ++bad) {
    grab();
    RgbdFrame frame;
    frame.index = next_ - 1;
    frame.clip_time_s = static_cast<double>(frame.index) / info_.fps;
    cv::Mat color;
    cv::Mat raw;
    problem = retrieve(color_, color);
    if (problem.empty()) problem = retrieve(depth_, raw);
    if (problem.empty()) {
      ImageResult depth = toDepth(raw, format_);
      frame.color = color.clone();
      frame.depth = depth.image;
      if (depth.ok()) return frame;
      problem = depth_.name + ": " + depth.problem;
    }
    // Logs the first fault and every doubling, so that a camera with occasional faults does not
    // fill the log.
    if (bad == 0 && std::has_single_bit(++faults_))
      spdlog::warn("{}; frame {} is left out (time {})", problem, frame.index, faults_);
  }
  throw SourceError(problem + ", " + std::to_string(kMostBad) +
                    " frames in a row; start the server again");
}

bool Camera::skip() {
  grab();
  return true;
}

void Camera::rewind() { throw SourceError(info_.name + ": is live and cannot be rewound"); }

}  // namespace hapticast::server
