// SPDX-License-Identifier: MIT
#include "server/source/video/video_with_depth.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "server/source/picture/depth_code.hpp"
#include "server/source/scale/depth_scale.hpp"
#include "server/source/scale/picture_scale.hpp"
#include "server/source/video/first_pictures.hpp"

namespace hapticast::server {

VideoWithDepth::VideoWithDepth(std::unique_ptr<VideoFile> video,
                               std::unique_ptr<DepthSequence> depth, VideoDepthFacts facts)
    : video_(std::move(video)), depth_(std::move(depth)), facts_(std::move(facts)) {
  const VideoTrack& track = video_->tracks().front();
  if (!sizeReadable(track.width_px, track.height_px)) {
    throw SourceError(video_->file() + ": " + describeTooLarge(track.width_px, track.height_px) +
                      "; scale it down");
  }
  video_->start(0);
  cv::Mat color;
  while (color.empty()) {
    if (!video_->grab(0))
      throw SourceError(video_->file() + ": has no frame that can be decoded; use another file");
    color = video_->retrieveColor(0);
  }
  info_.frame_count = countFrames();
  ImageResult first{{}, "has no depth"};
  std::uint64_t index = 0;
  for (std::string problem; !first.ok(); ++index) {
    auto picture = depth_->next();
    if (!picture) throw SourceError(problem + "; no depth picture can be read, so use others");
    first = std::move(*picture);
    if (problem.empty()) problem = depth_->pictureName(index) + ": " + first.problem;
  }
  describe(color, first.image, depth_->pictureName(index - 1));
  rewind();
  epoch_ = 0;
}

void VideoWithDepth::describe(const cv::Mat& color, const cv::Mat& raw, const std::string& name) {
  const FirstPictures first = describeFirst(color, raw, facts_.layout.code, name);
  color_size_ = first.color_size;
  depth_size_ = first.depth_size;
  format_.kind = first.depth_kind;
  constexpr double kMm_m = 1000.0;  // estimators and simulators write metres
  format_.mm_per_unit = facts_.mm_per_unit.value_or(raw.depth() == CV_32F ? kMm_m : 1.0);
  setDepthUnit(format_, facts_.layout.depth_unit_mm, name);
  info_.mm_per_unit = format_.mm_per_unit;
  info_.name = facts_.name;
  setSize(info_, color_size_, video_->file());
  if (depth_size_ != color_size_) logScaledDepth(name, depth_size_, frameSize(info_));
  info_.fps = facts_.fps > 0.0 ? facts_.fps : plausibleRate(video_->tracks().front().fps);
  info_.depth_kind = format_.kind;
  if (facts_.camera) info_.camera = scaleCamera(*facts_.camera, info_);
  if (!info_.camera && facts_.fov_deg)
    info_.camera = CameraModel::ofFieldOfView(*facts_.fov_deg, info_.width_px, info_.height_px);
}

std::uint64_t VideoWithDepth::countFrames() const {
  const std::uint64_t depths = depth_->count();
  const std::uint64_t colors = video_->tracks().front().frame_count;
  if (colors == 0) return depths;
  if (std::max(colors, depths) - std::min(colors, depths) > kCountTolerance) {
    throw SourceError(depth_->pictureName(depths - 1) + ": is picture " + std::to_string(depths) +
                      " and the last one, but the colour video has " + std::to_string(colors) +
                      " frames; cut both to the same frames");
  }
  return std::min(colors, depths);
}

void VideoWithDepth::rewind() {
  video_ = std::make_unique<VideoFile>(video_->file());
  video_->start(0);
  depth_->rewind();
  next_ = 0;
  any_read_ = false;
  ++epoch_;
}

bool VideoWithDepth::grab() {
  if (!video_->grab(0)) return false;
  if (next_ < depth_->count()) {
    ++next_;
    return true;
  }
  if (!std::exchange(cut_reported_, true)) {
    spdlog::warn("{}: ends after {} frames, before {}; the clip is cut there",
                 depth_->pictureName(depth_->count() - 1), depth_->count(), video_->file());
  }
  return false;
}

bool VideoWithDepth::skip() { return grab() && depth_->skip(); }

std::optional<RgbdFrame> VideoWithDepth::read() {
  const auto next = [this](RgbdFrame& frame) {
    frame.index = next_ - 1;
    frame.epoch = epoch_;
    frame.clip_time_s = static_cast<double>(frame.index) / info_.fps;
    return load(frame);
  };
  if (auto frame = skipped_.readNext([this] { return grab(); }, next)) {
    any_read_ = true;
    return frame;
  }
  if (!any_read_) {
    const bool has_run = !skipped_.problem().empty();
    throw SourceError((has_run ? skipped_.cancelRun() : video_->file() + ": has no frame") +
                      ", and no frame after it can be used either; put the files back");
  }
  skipped_.endRun();
  return std::nullopt;
}

std::string VideoWithDepth::load(RgbdFrame& frame) {
  const std::string depth_name = depth_->pictureName(frame.index) + ": ";
  ImageResult depth = depth_->next().value_or(ImageResult{{}, "has no depth any more"});
  if (!depth.ok()) return depth_name + depth.problem;
  frame.color = video_->retrieveColor(0);
  if (frame.color.size() != color_size_) {
    return video_->file() + ": frame " + std::to_string(frame.index) +
           " cannot be decoded or is not " + sizeText(color_size_.width, color_size_.height);
  }
  const cv::Mat decoded = decodeDepth(depth.image, facts_.layout.code);
  if (decoded.size() != depth_size_) {
    return depth_name + "is " + sizeText(decoded.cols, decoded.rows) +
           ", but the clip's depth is " + sizeText(depth_size_.width, depth_size_.height);
  }
  depth = toDepth(decoded, format_);
  if (!depth.ok()) return depth_name + depth.problem;
  frame.color = scaleColor(frame.color, frameSize(info_));
  frame.depth = scaleDepth(depth.image, format_.kind, frame.color);
  return "";
}

}  // namespace hapticast::server
