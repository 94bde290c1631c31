// SPDX-License-Identifier: MIT
#include "server/source/video/single_video.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "server/source/picture/depth_code.hpp"
#include "server/source/picture/picture_scale.hpp"

namespace hapticast::server {

namespace {

/// Returns the track with depth; nullopt if that is not clear.
std::optional<std::size_t> findDepthTrack(const std::vector<VideoTrack>& tracks) {
  const auto first = [&](auto VideoTrack::*fact) -> std::optional<std::size_t> {
    const auto found = std::find_if(tracks.begin(), tracks.end(),
                                    [&](const VideoTrack& track) { return track.*fact; });
    if (found == tracks.end()) return std::nullopt;
    return static_cast<std::size_t>(found - tracks.begin());
  };
  if (const auto kinect = first(&VideoTrack::kinect_depth)) return kinect;
  if (const auto named = first(&VideoTrack::depth_name)) return named;
  const auto isGreyTrack = [](const VideoTrack& track) { return track.grey; };
  if (std::count_if(tracks.begin(), tracks.end(), isGreyTrack) != 1) return std::nullopt;
  return first(&VideoTrack::grey);
}

std::size_t findColorTrack(const std::vector<VideoTrack>& tracks, std::size_t depth) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (i != depth && !tracks[i].grey) return i;
  }
  return depth == 0 ? 1 : 0;
}

}  // namespace

SingleVideo::SingleVideo(std::unique_ptr<VideoFile> video, const VideoLayout& layout, double fps)
    : file_(video->file()), layout_(layout.layout), video_(std::move(video)) {
  code_ = layout.code;
  chooseTracks();
  requireSizes();
  prepareRegistration();
  startTracks();
  cv::Mat color;
  cv::Mat depth;
  while (color.empty() || depth.empty()) {
    if (!grabFrame())
      throw SourceError(file_ + ": has no frame that can be decoded; use another " +
                        (video_->isLive() ? "stream" : "file"));
    (void)retrieveFrame(color, depth);
  }
  const VideoTrack& track = video_->tracks()[color_];
  if (layout_ == Layout::kSeparate) requireDepthFormat(video_->tracks()[depth_], file_);
  describe(color, depth, track, fps);
  if (camera_) info_.camera = scaleCamera(*camera_, info_);
  info_.live = video_->isLive();
  if (info_.live) return;
  if (track.frame_count > 0) info_.frame_count = track.frame_count;
  SingleVideo::open();  // back to the first frame
}

void SingleVideo::chooseTracks() {
  const std::vector<VideoTrack>& tracks = video_->tracks();
  if (layout_ != Layout::kSeparate) return;
  if (tracks.size() == 1) throwOneTrack();
  const auto depth = findDepthTrack(tracks);
  if (!depth) {
    throw SourceError(file_ + ": has " + std::to_string(tracks.size()) +
                      " video tracks, but it is not clear which one is the depth; name it (ffmpeg "
                      "-i FILE -map 0 -c copy -metadata:s:v:1 title=depth OUT.mkv)");
  }
  depth_ = *depth;
  color_ = findColorTrack(tracks, depth_);
}

void SingleVideo::prepareRegistration() {
  const VideoTrack& depth = video_->tracks()[depth_];
  const VideoTrack& color = video_->tracks()[color_];
  if (layout_ != Layout::kSeparate || !depth.kinect_depth) return;
  const std::string text = video_->attachment("calibration.json");
  if (!text.empty()) {
    const KinectCalibration calibration =
        parseKinectCalibration(text, file_ + ": its calibration.json");
    const auto from = depthCamera(calibration, {depth.width_px, depth.height_px});
    const auto to = colorCamera(calibration, {color.width_px, color.height_px});
    if (from && to) {
      registration_.emplace(*from, *to, calibration);
      camera_ = CameraModel{to->matrix(0, 0), to->matrix(1, 1), to->matrix(0, 2) + 0.5,
                            to->matrix(1, 2) + 0.5};
      spdlog::info("{}: its depth is registered to its colour by the attached calibration", file_);
      return;
    }
  }
  spdlog::warn(
      "--source {}: is a recording of an Azure Kinect or Orbbec {}; its depth is not aligned to "
      "its "
      "colour, so touch and picture do not match; align the depth to the colour first",
      file_, text.empty() ? "without calibration" : "of sizes that its calibration does not know");
}

void SingleVideo::throwOneTrack() {
  video_->start(0);
  cv::Mat picture;
  while (picture.empty() && video_->grab(0)) picture = video_->retrieveColor(0);
  const std::string guess = guessLayout(picture);
  if (!guess.empty()) throw SourceError(file_ + ": has one video track; it " + guess);
  if (video_->isLive()) {
    throw SourceError(
        file_ +
        ": has one video track; depth is needed too, so send it as a second track, or "
        "use --layout if the picture shows both");
  }
  throw SourceError(file_ +
                    ": is a single file with one video track; depth is needed too, so use "
                    "COLOR,DEPTH or a folder, or --layout if the picture shows both");
}

void SingleVideo::requireSizes() const {
  VideoTrack color = video_->tracks()[color_];
  if (layout_ == Layout::kSideBySide) color.width_px /= 2;
  if (layout_ == Layout::kTopBottom) color.height_px /= 2;
  requireVideoSize(color, file_);
  if (layout_ == Layout::kSeparate) requireVideoSize(video_->tracks()[depth_], file_);
}

void SingleVideo::open() {
  if (info_.live) throw SourceError(file_ + ": is live and cannot be rewound");
  video_ = std::make_unique<VideoFile>(file_);
  if (std::max(color_, depth_) >= video_->tracks().size())
    throw SourceError(file_ + ": has lost a video track; put the file back");
  startTracks();
}

void SingleVideo::startTracks() {
  video_->start(color_);
  if (layout_ == Layout::kSeparate) video_->start(depth_);
  color_time_s_ = -std::numeric_limits<double>::infinity();
  depth_grabbed_ = false;
}

double SingleVideo::clipTime_s() const {
  return info_.live ? video_->time_s(color_) : VideoSource::clipTime_s();
}

bool SingleVideo::followColor() {
  const double fps = video_->tracks()[depth_].fps;
  // Half a period of the depth, and what containers round.
  const double tolerance_s = 0.51 / (fps >= 1.0 ? fps : 25.0);
  while (!depth_grabbed_ || video_->time_s(depth_) < color_time_s_ - tolerance_s) {
    depth_grabbed_ = video_->grab(depth_);
    if (!depth_grabbed_) return false;
  }
  if (video_->time_s(depth_) > color_time_s_ + tolerance_s) problem_ = "has no depth at its time";
  return true;
}

bool SingleVideo::grabFrame() {
  problem_.clear();
  const bool color = video_->grab(color_);
  if (color && layout_ == Layout::kSeparate) {
    const double time_s = video_->time_s(color_);
    if (std::isfinite(time_s) && time_s <= color_time_s_) {
      problem_ = "has a time stamp that runs back; write the file anew (ffmpeg -i FILE -map 0 OUT)";
      return true;
    }
    if (!std::isfinite(time_s)) return true;  // a damaged frame
    color_time_s_ = time_s;
    if (followColor()) return true;
    if (next() > 0 && !cut_reported_) {
      cut_reported_ = true;
      spdlog::warn("{}: its depth ends after {} frames, before its colour; the clip is cut there",
                   file_, next());
    }
    return false;
  }
  if (!color && next() == 0 && info_.width_px > 0)
    throw SourceError(file_ + ": has no frame that can be decoded any more; put the file back");
  return color;
}

std::string SingleVideo::retrieveFrame(cv::Mat& color, cv::Mat& depth) {
  if (!problem_.empty()) return problem_;
  if (layout_ == Layout::kSeparate) {
    color = video_->retrieveColor(color_);
    depth = video_->retrieveDepth(depth_);
    if (registration_ && !depth.empty()) {
      const VideoTrack& track = video_->tracks()[depth_];
      if (depth.type() != CV_16UC1 || depth.size() != cv::Size(track.width_px, track.height_px))
        return "has depth of another format than the clip";
      depth = registration_->run(depth);
    }
    return "";
  }
  const cv::Mat picture = video_->retrieveColor(color_);
  if (picture.cols < 2 || picture.rows < 2) return "";
  const PictureHalves halves = splitPicture(picture, {layout_, code_});
  color = halves.color.clone();
  depth = halves.depth;
  return "";
}

}  // namespace hapticast::server
