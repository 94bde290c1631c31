// SPDX-License-Identifier: MIT
#include "server/source/video/video_pair.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hapticast::server {

namespace {

/// Videos that differ by up to so many frames are cut; a larger difference means that they do not
/// belong together.
constexpr std::uint64_t kCountTolerance = 5;

std::unique_ptr<VideoFile> openVideo(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw SourceError(file +
                      ": is a folder, but a pair is two video files; a folder of images is "
                      "one source, with rgb/ and depth/");
  }
  auto video = std::make_unique<VideoFile>(file);
  requireVideoSize(video->tracks().front(), file);
  video->start(0);
  return video;
}

/// Returns the first frame that is whole.
cv::Mat firstFrame(VideoFile& video, bool depth) {
  while (video.grab(0)) {
    if (depth) requireDepthFormat(video.tracks().front(), video.file());
    cv::Mat frame = depth ? video.retrieveDepth(0) : video.retrieveColor(0);
    if (!frame.empty()) return frame;
  }
  throw SourceError(video.file() + ": has no frame that can be decoded; use another file");
}

}  // namespace

VideoPair::VideoPair(std::string color_file, std::string depth_file, double fps, DepthCode code)
    : color_file_(std::move(color_file)), depth_file_(std::move(depth_file)) {
  code_ = code;
  std::error_code error;
  if (std::filesystem::equivalent(color_file_, depth_file_, error)) {
    throw SourceError(depth_file_ +
                      ": is the colour video and the depth video; name a grey video "
                      "of the depth (near is white) as the second one");
  }
  VideoPair::open();
  const cv::Mat color = firstFrame(*color_, false);
  const cv::Mat depth = firstFrame(*depth_, true);
  describe(color, depth, color_->tracks().front(), fps);
  warnOfOtherRate();
  info_.frame_count = countFrames();
  VideoPair::open();  // back to the first frame
}

void VideoPair::warnOfOtherRate() const {
  constexpr double kSameRate = 0.01;  // chosen: 29.97 and 30 frames/s are one rate
  const double color = color_->tracks().front().fps;
  const double depth = depth_->tracks().front().fps;
  if (!(color >= 1.0 && depth >= 1.0) || std::abs(color - depth) <= kSameRate * color) return;
  spdlog::warn(
      "--source {}: has {:.4g} frames/s, but the colour video has {:.4g}; the server pairs frames "
      "by "
      "number, so convert one to the other's rate (ffmpeg -i FILE -vf fps={:.4g} OUT)",
      depth_file_, depth, color, color);
}

std::optional<std::uint64_t> VideoPair::countFrames() const {
  const std::uint64_t colors = color_->tracks().front().frame_count;
  const std::uint64_t depths = depth_->tracks().front().frame_count;
  if (colors == 0 || depths == 0) return std::nullopt;
  if (std::max(colors, depths) - std::min(colors, depths) > kCountTolerance) {
    throw SourceError(depth_file_ + ": has " + std::to_string(depths) +
                      " frames, but the colour video has " + std::to_string(colors) +
                      "; cut both to the same frames");
  }
  return std::min(colors, depths);
}

void VideoPair::open() {
  color_ = openVideo(color_file_);
  depth_ = openVideo(depth_file_);
}

bool VideoPair::grabFrame() {
  const bool color = color_->grab(0);
  const bool depth = depth_->grab(0);
  if (color && depth) return true;
  if (next() == 0) {
    throw SourceError((color ? depth_file_ : color_file_) +
                      ": has no frame that can be decoded any more; put the file back");
  }
  if (color != depth && !cut_reported_) {
    cut_reported_ = true;
    spdlog::warn("{}: ends after {} frames, before {}; the clip is cut there",
                 color ? depth_file_ : color_file_, next(), color ? color_file_ : depth_file_);
  }
  return false;
}

std::string VideoPair::retrieveFrame(cv::Mat& color, cv::Mat& depth) {
  color = color_->retrieveColor(0);
  depth = depth_->retrieveDepth(0);
  return "";
}

}  // namespace hapticast::server
