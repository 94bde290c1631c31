// SPDX-License-Identifier: MIT
#include "server/source/video_source.hpp"

#include <spdlog/spdlog.h>

#include <bit>

#include "server/source/depth_code.hpp"
#include "server/source/depth_scale.hpp"
#include "server/source/picture_scale.hpp"

namespace hapticast::server {

namespace {

constexpr std::uint64_t kFewMissing = 5;  // chosen: files often state a few frames too many

}  // namespace

void requireVideoSize(const VideoTrack& track, const std::string& file) {
  if (sizeReadable(track.width_px, track.height_px)) return;
  const bool known = track.width_px > 0;  // else the decoder refused them
  throw SourceError(file + ": " +
                    (known ? describeTooLarge(track.width_px, track.height_px)
                           : "has pictures that cannot be decoded or are larger than " +
                                 sizeText(kMostSide_px, 4320)) +
                    "; scale it down");
}

void requireDepthFormat(const VideoTrack& track, const std::string& file) {
  if (track.grey || track.bits <= 8) return;
  throw SourceError(file + ": depth video with " + std::to_string(track.bits) +
                    " bits must be grey, but it is " + track.format +
                    "; convert it to mm (ffmpeg -i FILE -pix_fmt gray16le -c:v ffv1 OUT.mkv), or "
                    "to 8-bit grey (-pix_fmt gray)");
}

bool isMetric(const cv::Mat& depth) { return depth.depth() != CV_8U; }

void VideoSource::describe(const cv::Mat& color, const cv::Mat& raw, const VideoTrack& track,
                           double fps) {
  const std::string& file = fileOf(true);
  if (isMetric(raw) && code_ != DepthCode::kGrey)
    throw SourceError(file + ": has depth in mm, so leave --depth-near and --depth-code out");
  const cv::Mat depth = decodeDepth(raw, code_);
  if (!isSameAspect(depth.size(), color.size())) {
    throw SourceError(file + ": is " + sizeText(depth.cols, depth.rows) +
                      ", but the colour video is " + sizeText(color.cols, color.rows) +
                      "; scale one to the other's size");
  }
  if (isColorCoded(depth))
    throw SourceError(file + ": shows depth as colours; make it grey (near is white)");
  color_size_ = color.size();
  depth_size_ = depth.size();
  format_.kind = isMetric(depth) ? DepthKind::kMetric : DepthKind::kHeight;
  info_.name = fileName(fileOf(false));
  setSize(info_, color_size_, fileOf(false));
  if (depth_size_ != color_size_) logScaledDepth(file, depth_size_, frameSize(info_));
  // Without a plausible rate of the file, the clip has that of most films.
  const bool plausible = track.fps >= 1.0 && track.fps <= 240.0;
  info_.fps = fps > 0.0 ? fps : (plausible ? track.fps : 25.0);
  info_.depth_kind = format_.kind;
}

bool VideoSource::grab() {
  if (ended_) return false;
  if (grabFrame()) {
    ++next_;
    return true;
  }
  ended_ = true;
  if (info_.frame_count && next_ + kFewMissing < *info_.frame_count && !cut_reported_) {
    cut_reported_ = true;
    spdlog::warn("{}: ends after frame {}, but states {} frames; the file is cut off or damaged",
                 fileOf(false), next_ - 1, *info_.frame_count);
  }
  return false;
}

std::string VideoSource::load(RgbdFrame& frame) {
  cv::Mat raw;
  const std::string problem = retrieveFrame(frame.color, raw);
  if (!problem.empty())
    return fileOf(true) + ": frame " + std::to_string(frame.index) + " " + problem;
  const bool color = frame.color.size() == color_size_;
  const bool depth = raw.size() == depth_size_;
  if (!color || !depth) {
    const cv::Size wanted = color ? depth_size_ : color_size_;
    return fileOf(color) + ": frame " + std::to_string(frame.index) +
           " cannot be decoded or is not " + sizeText(wanted.width, wanted.height);
  }
  ImageResult converted = toDepth(decodeDepth(raw, code_), format_);
  if (!converted.ok())
    return fileOf(true) + ": frame " + std::to_string(frame.index) + " " + converted.problem;
  frame.color = scaleColor(frame.color, frameSize(info_));
  frame.depth = scaleDepth(converted.image, format_.kind, frame.color);
  return "";
}

std::optional<RgbdFrame> VideoSource::read() {
  std::string problem;  // problem of frame `first_bad`
  std::uint64_t first_bad = 0;
  const auto warnAboutSkips = [&] {
    if (problem.empty() || !isNewFault(first_bad)) return;
    spdlog::warn("{}; this frame and later frames with the same problem are left out", problem);
  };
  while (grab()) {
    RgbdFrame frame;
    frame.index = next_ - 1;
    frame.epoch = epoch_;
    frame.clip_time_s = clipTime_s();
    const std::string what = load(frame);
    if (what.empty()) {
      any_read_ = true;
      warnAboutSkips();
      return frame;
    }
    if (!problem.empty()) continue;
    first_bad = frame.index;
    problem = what;
  }
  if (!any_read_) {
    throw SourceError(problem + ", and no frame after it can be used either; put the file back");
  }
  warnAboutSkips();
  return std::nullopt;
}

double VideoSource::clipTime_s() const { return static_cast<double>(next_ - 1) / info_.fps; }

bool VideoSource::isNewFault(std::uint64_t first_bad) {
  // A live source never comes back to a frame: its first fault counts, and every doubling.
  return info_.live ? std::has_single_bit(++faults_) : reported_.insert(first_bad).second;
}

bool VideoSource::skip() { return grab(); }

void VideoSource::rewind() {
  open();
  next_ = 0;
  ended_ = false;
  any_read_ = false;
  ++epoch_;
}

}  // namespace hapticast::server
