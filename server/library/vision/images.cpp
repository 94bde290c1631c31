// SPDX-License-Identifier: MIT
#include "server/library/vision/images.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>

#include "common/haptic_frame.hpp"
#include "common/library/require.hpp"
#include "common/text.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

constexpr int kSmallestSide_px = 16;
constexpr float kMostLevel = 255.0F;

/// Returns a view of `values`. The caller must not write to it.
template <class Value>
cv::Mat viewValues(const std::vector<Value>& values, int width_px, int height_px, int type) {
  return {height_px, width_px, type, const_cast<Value*>(values.data())};
}

/// Copies all values of `image` to `values`.
template <class Value>
void copyTo(std::vector<Value>& values, const cv::Mat& image) {
  values.resize(image.total() * static_cast<std::size_t>(image.channels()));
  cv::Mat out(image.rows, image.cols, image.type(), values.data());
  image.copyTo(out);
}

void checkCamera(const SourceInfo::Camera& camera) {
  const bool finite = std::isfinite(camera.fx_px) && std::isfinite(camera.fy_px) &&
                      std::isfinite(camera.cx_px) && std::isfinite(camera.cy_px);
  require(finite && camera.fx_px > 0.0 && camera.fy_px > 0.0,
          "camera: fx_px and fy_px have to be above 0, and all values finite");
}

void checkDepths(const std::vector<float>& depth, bool metric) {
  // One pass without a branch: the compiler makes vectors of it.
  const float least = metric ? std::numeric_limits<float>::lowest() : 0.0F;
  const float most = metric ? std::numeric_limits<float>::max() : kMostLevel;
  int wrong = 0;
  for (const float each : depth) wrong += int(each >= least) & int(each <= most) ? 0 : 1;
  require(wrong == 0, "depth: " + std::to_string(wrong) + " pixels are " +
                          (metric ? "not finite; use 0 where depth was not measured"
                                  : "outside 0..255, the range without SourceInfo::metric"));
}

}  // namespace

SourceInfo exportSourceInfo(const server::SourceInfo& info) {
  SourceInfo to;
  to.name = info.name;
  to.width_px = info.width_px;
  to.height_px = info.height_px;
  to.fps = info.fps;
  to.metric = info.depth_kind == server::DepthKind::kMetric;
  to.live = info.live;
  to.frames = info.frame_count.value_or(0);
  if (info.camera)
    to.camera = {info.camera->fx_px, info.camera->fy_px, info.camera->cx_px, info.camera->cy_px};
  return to;
}

server::SourceInfo importSourceInfo(const SourceInfo& info) {
  require(info.width_px >= kSmallestSide_px && info.width_px <= kMaxWidth_px &&
              info.height_px >= kSmallestSide_px && info.height_px <= kMaxHeight_px,
          "size: " + std::to_string(info.width_px) + " x " + std::to_string(info.height_px) +
              " px is outside 16 x 16 .. 1920 x 1080 px");
  require(info.fps >= limits::kMinFps && info.fps <= limits::kMaxFps,
          "fps: " + std::to_string(info.fps) + " is outside 1..240");
  require(info.name.size() <= limits::kStreamName && sanitizeUtf8(info.name) == info.name,
          "name: " + quote(info.name) + " is not UTF-8 of at most 256 bytes");
  server::SourceInfo to;
  to.name = info.name;
  to.width_px = info.width_px;
  to.height_px = info.height_px;
  to.fps = info.fps;
  to.depth_kind = info.metric ? server::DepthKind::kMetric : server::DepthKind::kHeight;
  to.live = true;
  if (info.camera) {
    checkCamera(*info.camera);
    to.camera = server::CameraModel{info.camera->fx_px, info.camera->fy_px, info.camera->cx_px,
                                    info.camera->cy_px};
  }
  return to;
}

Images exportImages(const server::RgbdFrame& frame, double time_s) {
  Images to;
  to.width_px = frame.depth.cols;
  to.height_px = frame.depth.rows;
  to.index = frame.index;
  to.epoch = frame.epoch;
  to.time_s = time_s;
  cv::Mat rgb;
  cv::cvtColor(frame.color, rgb, cv::COLOR_BGR2RGB);
  copyTo(to.rgb, rgb);
  copyTo(to.depth, frame.depth);
  for (float& each : to.depth) each = std::isfinite(each) ? each : 0.0F;
  if (!frame.mask.empty()) copyTo(to.mask, frame.mask);
  return to;
}

server::RgbdFrame importImages(const Images& images) {
  const int width_px = images.width_px;
  const int height_px = images.height_px;
  server::RgbdFrame to;
  to.index = images.index;
  to.epoch = images.epoch;
  if (images.rgb.empty()) {
    to.color = cv::Mat::zeros(height_px, width_px, CV_8UC3);
  } else {
    cv::cvtColor(viewValues(images.rgb, width_px, height_px, CV_8UC3), to.color, cv::COLOR_RGB2BGR);
  }
  to.depth = viewValues(images.depth, width_px, height_px, CV_32FC1).clone();
  if (!images.mask.empty()) to.mask = viewValues(images.mask, width_px, height_px, CV_8UC1).clone();
  return to;
}

void checkImages(const Images& images, const server::SourceInfo& info) {
  require(images.width_px == info.width_px && images.height_px == info.height_px,
          "images: " + std::to_string(images.width_px) + " x " + std::to_string(images.height_px) +
              " px, the source has " + std::to_string(info.width_px) + " x " +
              std::to_string(info.height_px) + " px");
  const std::size_t pixels =
      static_cast<std::size_t>(info.width_px) * static_cast<std::size_t>(info.height_px);
  const auto requireCount = [](const char* what, std::size_t has, std::size_t needed) {
    require(has == needed, std::string(what) + ": " + std::to_string(has) +
                               " values, the images need " + std::to_string(needed));
  };
  requireCount("depth", images.depth.size(), pixels);
  if (!images.rgb.empty()) requireCount("rgb", images.rgb.size(), 3 * pixels);
  if (!images.mask.empty()) requireCount("mask", images.mask.size(), pixels);
  checkDepths(images.depth, info.depth_kind == server::DepthKind::kMetric);
}

}  // namespace hapticast
