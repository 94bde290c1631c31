// SPDX-License-Identifier: MIT
#include "server/source/video_pair.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "server/source/image_file.hpp"

namespace hapticast::server {

namespace {

/// Videos that differ by up to so many frames are cut; a larger difference means that they do not
/// belong together.
constexpr double kCountTolerance = 5.0;

cv::VideoCapture openVideo(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw SourceError(file +
                      ": is a folder, but a pair is two video files; a folder of images is "
                      "one source, with rgb/ and depth/");
  }
  if (!std::filesystem::is_regular_file(file, error)) throw SourceError(file + ": no such file");
  // FFmpeg's own log would hide the error message. OpenCV reads this variable once, at the first
  // video; a value set by the user takes precedence.
  static const int quiet = ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  static_cast<void>(quiet);
  // FFmpeg only: other back ends accept other inputs (image patterns, pipelines) and hide the pixel
  // format.
  cv::VideoCapture capture(file, cv::CAP_FFMPEG);
  if (!capture.isOpened()) {
    throw SourceError(file +
                      ": holds no video that can be read; convert it, for example to H.264 in MP4");
  }
  const double width = capture.get(cv::CAP_PROP_FRAME_WIDTH);
  const double height = capture.get(cv::CAP_PROP_FRAME_HEIGHT);
  if (!sizeAllowed(static_cast<int>(width), static_cast<int>(height))) {
    throw SourceError(file + ": is " + sizeText(static_cast<int>(width), static_cast<int>(height)) +
                      "; allowed is up to 1920x1080, so scale it down");
  }
  return capture;
}

cv::Mat firstFrame(cv::VideoCapture& capture, const std::string& file) {
  cv::Mat frame;
  if (!capture.read(frame) || frame.type() != CV_8UC3) {
    throw SourceError(file + ": has no frame that can be decoded; use another file");
  }
  return frame;
}

void requireEightBitDepth(const cv::VideoCapture& capture, const std::string& file) {
  const auto tag = static_cast<std::uint32_t>(
      static_cast<std::int64_t>(capture.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT)));
  if (isEightBitFormat(tag)) return;
  throw SourceError(file +
                    ": depth video with more than 8 bits per sample would be read wrongly; make a "
                    "folder with rgb/ "
                    "and 16-bit depth/ PNG files of it (ffmpeg -i FILE -pix_fmt gray16be "
                    "depth/%06d.png), or 8-bit "
                    "grey video (ffmpeg -i FILE -pix_fmt gray -c:v ffv1 OUT.mkv)");
}

/// Returns the rate stated by the file; 25 if it is implausible.
double readFrameRate(const cv::VideoCapture& capture) {
  const double fps = capture.get(cv::CAP_PROP_FPS);
  return fps >= 1.0 && fps <= 240.0 ? fps : 25.0;
}

}  // namespace

bool isEightBitFormat(std::uint32_t tag) {
  // FFmpeg's tags, by name: grey, planar and packed YUV, RGB with and without alpha, palette. A
  // list of safe formats, because the others (10 to 64 bits, and formats without a tag of FFmpeg's
  // own) are many.
  using Tag = std::array<char, 4>;
  constexpr std::array<Tag, 26> kTags{
      {{'Y', '8', '0', '0'},  {'I', '4', '2', '0'},  {'Y', '4', '2', 'B'},  {'4', '4', '4', 'P'},
       {'4', '4', '0', 'P'},  {'Y', '4', '1', 'B'},  {'Y', 'U', 'V', '9'},  {'N', 'V', '1', '2'},
       {'N', 'V', '2', '1'},  {'Y', 'U', 'Y', '2'},  {'U', 'Y', 'V', 'Y'},  {'Y', 'V', 'Y', 'U'},
       {'A', 'B', 'G', 'R'},  {'A', 'R', 'G', 'B'},  {'R', 'G', 'B', 'A'},  {'B', 'G', 'R', 'A'},
       {'R', 'G', 'B', '\0'}, {'B', 'G', 'R', '\0'}, {'\0', 'R', 'G', 'B'}, {'\0', 'B', 'G', 'R'},
       {'R', 'G', 'B', 24},   {'B', 'G', 'R', 24},   {'G', '3', '\0', 8},   {'G', '4', '\0', 8},
       {'Y', '2', '\0', 8},   {'P', 'A', 'L', 8}}};
  return std::any_of(kTags.begin(), kTags.end(), [&](const Tag& known) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i) {
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(known[i])) << (8U * i);
    }
    return value == tag;
  });
}

VideoPair::VideoPair(std::string color_file, std::string depth_file, double fps)
    : color_file_(std::move(color_file)), depth_file_(std::move(depth_file)) {
  std::error_code error;
  if (std::filesystem::equivalent(color_file_, depth_file_, error)) {
    throw SourceError(depth_file_ +
                      ": is the colour video and the depth video; name a grey video "
                      "of the depth (near is white) as the second one");
  }
  open();
  requireEightBitDepth(depth_, depth_file_);
  const cv::Mat color = firstFrame(color_, color_file_);
  const cv::Mat depth = firstFrame(depth_, depth_file_);
  if (color.size() != depth.size()) {
    throw SourceError(depth_file_ + ": is " + sizeText(depth.cols, depth.rows) +
                      ", but the colour video is " + sizeText(color.cols, color.rows) +
                      "; scale one to the other's size");
  }
  if (isColorCoded(depth)) {
    throw SourceError(depth_file_ + ": shows depth as colours; make it grey (near is white)");
  }
  warnOfOtherRate();
  info_.frame_count = countFrames();
  info_.name = fileName(color_file_);
  info_.width_px = color.cols;
  info_.height_px = color.rows;
  info_.fps = fps > 0.0 ? fps : readFrameRate(color_);
  info_.depth_kind = DepthKind::kHeight;
  open();  // back to the first frame
}

void VideoPair::warnOfOtherRate() const {
  constexpr double kSameRate = 0.01;  // chosen: 29.97 and 30 frames/s are one rate
  const double color = color_.get(cv::CAP_PROP_FPS);
  const double depth = depth_.get(cv::CAP_PROP_FPS);
  if (!(color >= 1.0 && depth >= 1.0) || std::abs(color - depth) <= kSameRate * color) return;
  spdlog::warn(
      "--source {}: has {:.4g} frames/s, but the colour video has {:.4g}; the server pairs frames "
      "by "
      "number, so convert one to the other's rate (ffmpeg -i FILE -vf fps={:.4g} OUT)",
      depth_file_, depth, color, color);
}

std::optional<std::uint64_t> VideoPair::countFrames() const {
  const double colors = color_.get(cv::CAP_PROP_FRAME_COUNT);
  const double depths = depth_.get(cv::CAP_PROP_FRAME_COUNT);
  // Not every container states its count; implausible counts are unknown.
  const bool known = colors >= 1.0 && depths >= 1.0 && colors < 1e9 && depths < 1e9;
  if (known && std::abs(colors - depths) > kCountTolerance) {
    throw SourceError(depth_file_ + ": has " + std::to_string(std::llround(depths)) +
                      " frames, but the colour video has " + std::to_string(std::llround(colors)) +
                      "; cut both to the same frames");
  }
  if (!known) return std::nullopt;
  return static_cast<std::uint64_t>(std::min(colors, depths));
}

void VideoPair::open() {
  color_ = openVideo(color_file_);
  depth_ = openVideo(depth_file_);
}

bool VideoPair::grab() {
  if (ended_) return false;
  const bool color = color_.grab();
  const bool depth = depth_.grab();
  if (color && depth) {
    ++next_;
    return true;
  }
  ended_ = true;
  if (next_ == 0) {
    throw SourceError((color ? depth_file_ : color_file_) +
                      ": has no frame that can be decoded any more; put the file back");
  }
  if (color != depth && !cut_reported_) {
    cut_reported_ = true;
    spdlog::warn("{}: ends after {} frames, before {}; the clip is cut there",
                 color ? depth_file_ : color_file_, next_, color ? color_file_ : depth_file_);
  }
  return false;
}

std::optional<RgbdFrame> VideoPair::read() {
  std::string problem;  // problem of frame `first_bad`
  std::uint64_t first_bad = 0;
  const auto tell = [&] {  // once, not in every round
    if (problem.empty() || !reported_.insert(first_bad).second) return;
    spdlog::warn("{}; this frame and later frames with the same problem are left out", problem);
  };
  while (grab()) {
    RgbdFrame frame;
    frame.index = next_ - 1;
    frame.epoch = epoch_;
    frame.clip_time_s = static_cast<double>(frame.index) / info_.fps;
    cv::Mat raw;
    const cv::Size size(info_.width_px, info_.height_px);
    const bool color = color_.retrieve(frame.color) && frame.color.size() == size;
    const bool depth = depth_.retrieve(raw) && raw.size() == size;
    if (color && depth) {
      // The decoder reuses its buffer for the next frame; toDepth() makes its own.
      frame.color = frame.color.clone();
      frame.depth = toDepth(raw, {DepthKind::kHeight}).image;
      any_read_ = true;
      tell();
      return frame;
    }
    if (!problem.empty()) continue;
    first_bad = frame.index;
    problem = (color ? depth_file_ : color_file_) + ": frame " + std::to_string(frame.index) +
              " cannot be decoded or is not " + sizeText(size.width, size.height);
  }
  if (!any_read_) {
    throw SourceError(problem + ", and no frame after it can be used either; put the file back");
  }
  tell();
  return std::nullopt;
}

bool VideoPair::skip() { return grab(); }

void VideoPair::rewind() {
  open();
  next_ = 0;
  ended_ = false;
  any_read_ = false;
  ++epoch_;
}

}  // namespace hapticast::server
