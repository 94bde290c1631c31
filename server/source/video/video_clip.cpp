// SPDX-License-Identifier: MIT
#include "server/source/video/video_clip.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/source/picture/depth_code.hpp"
#include "server/source/scale/depth_scale.hpp"
#include "server/source/scale/picture_scale.hpp"

namespace hapticast::server {

namespace {

constexpr std::uint64_t kFewMissing = 5;  // chosen: files often state a few frames too many

std::shared_ptr<VideoFile> reopen(const VideoChannel& channel) {
  auto video = std::make_shared<VideoFile>(channel.file->file());
  if (channel.track >= video->tracks().size())
    throw SourceError(video->file() + ": has lost a video track; put the file back");
  return video;
}

}  // namespace

std::optional<RgbdFrame> VideoClip::read() {
  const auto next = [this](RgbdFrame& frame) {
    frame.index = next_ - 1;
    frame.epoch = epoch_;
    frame.clip_time_s = info_.live ? color_.file->time_s(color_.track)
                                   : static_cast<double>(frame.index) / info_.fps;
    return load(frame);
  };
  if (auto frame = skipped_.readNext([this] { return grab(); }, next)) {
    any_read_ = true;
    return frame;
  }
  if (!any_read_) {
    throw SourceError(skipped_.cancelRun() +
                      ", and no frame after it can be used either; put the file back");
  }
  skipped_.endRun();
  return std::nullopt;
}

void VideoClip::rewind() {
  if (info_.live) throw SourceError(color_.file->file() + ": is live and cannot be rewound");
  const bool pair = isPair();
  color_.file = reopen(color_);
  depth_.file = pair ? reopen(depth_) : color_.file;
  startTracks();
  next_ = 0;
  ended_ = false;
  any_read_ = false;
  ++epoch_;
}

void VideoClip::startTracks() {
  color_.file->start(color_.track);
  if (hasDepthTrack()) depth_.file->start(depth_.track);
  color_time_s_ = -std::numeric_limits<double>::infinity();
  depth_grabbed_ = false;
}

bool VideoClip::grab() {
  if (ended_) return false;
  if (grabFrame()) {
    if (by_time_ && std::isfinite(color_time_s_)) {
      const double slot = std::round(color_time_s_ * nominalRate());
      next_ = std::max(next_, static_cast<std::uint64_t>(std::max(slot, 0.0)));
    }
    ++next_;
    return true;
  }
  ended_ = true;
  if (info_.frame_count && next_ + kFewMissing < *info_.frame_count)
    logCut(
        fmt::format("{}: ends after frame {}, but states {} frames; the file is cut off or "
                    "damaged",
                    color_.file->file(), next_ - 1, *info_.frame_count));
  return false;
}

bool VideoClip::grabFrame() { return isPair() && !by_time_ ? grabByNumber() : grabByTime(); }

void VideoClip::throwNoFrame(const VideoChannel& channel) const {
  const bool began = info_.width_px > 0;
  throw SourceError(channel.file->file() + ": has no frame that can be decoded" +
                    (began ? " any more; put the file back"
                           : (info_.live ? "; use another stream" : "; use another file")));
}

void VideoClip::logCut(const std::string& text) {
  if (!std::exchange(cut_reported_, true)) spdlog::warn("{}", text);
}

bool VideoClip::grabByNumber() {
  const bool color = color_.file->grab(color_.track);
  const bool depth = depth_.file->grab(depth_.track);
  if (color && depth) return true;
  const VideoChannel& shorter = color ? depth_ : color_;
  const VideoChannel& longer = color ? color_ : depth_;
  if (next_ == 0) throwNoFrame(shorter);
  if (color != depth)
    logCut(fmt::format("{}: ends after {} frames, before {}; the clip is cut there",
                       shorter.file->file(), next_, longer.file->file()));
  return false;
}

bool VideoClip::grabByTime() {
  problem_.clear();
  if (!color_.file->grab(color_.track)) {
    if (next_ == 0 && info_.width_px > 0) throwNoFrame(color_);
    return false;
  }
  if (!hasDepthTrack()) return true;
  const double time_s = color_.time_s();
  if (std::isfinite(time_s) && time_s <= color_time_s_) {
    problem_ = "has a time stamp that runs back; write the file anew (ffmpeg -i FILE -map 0 OUT)";
    return true;
  }
  if (!std::isfinite(time_s)) return true;  // a damaged frame
  color_time_s_ = time_s;
  if (followColor()) return true;
  if (by_time_ && next_ == 0) throwNoFrame(depth_);
  if (!by_time_ && next_ > 0)  // checkTimes() named the end of a pair
    logCut(
        fmt::format("{}: its depth ends after {} frames, before its colour; the clip is cut "
                    "there",
                    color_.file->file(), next_));
  return false;
}

bool VideoClip::followColor() {
  const double fps = depth_.facts().fps;
  // Half a period of the depth, and what containers round.
  double tolerance_s = 0.51 / (fps >= 1.0 ? fps : 25.0);
  double least_s = color_time_s_ - tolerance_s;
  if (by_time_) {
    constexpr double kSame_s = 1e-6;
    const std::vector<double>& times_s = by_time_->depth.times_s;
    tolerance_s = by_time_->depth.tolerance_s();
    if (color_time_s_ > times_s.back() + tolerance_s) return false;
    least_s = nearestTime_s(times_s, color_time_s_) - kSame_s;
  }
  if (!grabDepthFrom(least_s)) return false;
  if (std::abs(depth_.time_s() - color_time_s_) <= tolerance_s) return true;
  problem_ = depth_damaged_ ? "has depth that cannot be decoded" : "has no depth at its time";
  return true;
}

bool VideoClip::grabDepthFrom(double least_s) {
  for (bool damaged = false; !depth_grabbed_ || depth_.time_s() < least_s;) {
    depth_grabbed_ = depth_.file->grab(depth_.track);
    if (!depth_grabbed_) return false;
    damaged = damaged || !std::isfinite(depth_.time_s());
    depth_damaged_ = damaged;
  }
  return true;
}

std::string VideoClip::retrieve(cv::Mat& color, cv::Mat& depth) {
  if (!problem_.empty()) return problem_;
  if (hasHalves()) {
    const cv::Mat picture = color_.file->retrieveColor(color_.track);
    if (picture.cols < 2 || picture.rows < 2) return "";
    const PictureHalves halves = splitPicture(picture, layout_);
    color = halves.color.clone();
    depth = halves.depth;
    return "";
  }
  color = color_.file->retrieveColor(color_.track);
  if (layout_.color_only) return "";
  depth = depth_.file->retrieveDepth(depth_.track);
  if (!registration_ || depth.empty()) return "";
  const VideoTrack& track = depth_.facts();
  if (depth.type() != CV_16UC1 || depth.size() != cv::Size(track.width_px, track.height_px))
    return "has depth of another format than the clip";
  depth = registration_->run(depth);
  return "";
}

std::string VideoClip::describeProblem(const VideoChannel& channel, std::uint64_t index,
                                       const std::string& problem) {
  return channel.file->file() + ": frame " + std::to_string(index) + " " + problem;
}

std::string VideoClip::load(RgbdFrame& frame) {
  cv::Mat raw;
  const std::string problem = retrieve(frame.color, raw);
  if (!problem.empty()) return describeProblem(color_, frame.index, problem);
  const bool color = frame.color.size() == color_size_;
  if (!color || raw.size() != depth_size_) {
    const cv::Size wanted = color ? depth_size_ : color_size_;
    return describeProblem(color ? depth_ : color_, frame.index,
                           "cannot be decoded or is not " + sizeText(wanted.width, wanted.height));
  }
  frame.color = scaleColor(frame.color, frameSize(info_));
  if (layout_.color_only) return "";
  ImageResult converted = toDepth(decodeDepth(raw, layout_.code), format_);
  if (!converted.ok()) return describeProblem(depth_, frame.index, converted.problem);
  frame.depth = scaleDepth(converted.image, format_.kind, frame.color);
  return "";
}

}  // namespace hapticast::server
