// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "server/source/picture/depth_code.hpp"
#include "server/source/scale/depth_scale.hpp"
#include "server/source/scale/picture_scale.hpp"
#include "server/source/video/first_pictures.hpp"
#include "server/source/video/video_clip.hpp"

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

/// Returns the track with colour. `depth`: the track with depth; a number that no track has if
/// there is none.
std::size_t findColorTrack(const std::vector<VideoTrack>& tracks, std::size_t depth) {
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (i != depth && !tracks[i].grey) return i;
  }
  return depth == 0 ? 1 : 0;
}

std::shared_ptr<VideoFile> openVideo(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw SourceError(file +
                      ": is a folder, but a pair is two video files; a folder of images is "
                      "one source, with rgb/ and depth/");
  }
  return std::make_shared<VideoFile>(file);
}

/// Throws SourceError if `track` of `file` is too large to be a source.
void requireVideoSize(const VideoTrack& track, const std::string& file) {
  if (sizeReadable(track.width_px, track.height_px)) return;
  const bool known = track.width_px > 0;  // else the decoder refused them
  throw SourceError(file + ": " +
                    (known ? describeTooLarge(track.width_px, track.height_px)
                           : "has pictures that cannot be decoded or are larger than " +
                                 sizeText(kMostSide_px, 4320)) +
                    "; scale it down");
}

/// Throws SourceError if the values of `track` are no depth: more than 8 bits, but not grey.
void requireDepthFormat(const VideoTrack& track, const std::string& file) {
  if (track.grey || track.bits <= 8) return;
  throw SourceError(file + ": depth video with " + std::to_string(track.bits) +
                    " bits must be grey, but it is " + track.format +
                    "; convert it to mm (ffmpeg -i FILE -pix_fmt gray16le -c:v ffv1 OUT.mkv), or "
                    "to 8-bit grey (-pix_fmt gray)");
}

}  // namespace

VideoClip::VideoClip(const std::string& color_file, const std::string& depth_file, double fps,
                     const VideoLayout& layout)
    : layout_(layout) {
  std::error_code error;
  if (std::filesystem::equivalent(color_file, depth_file, error)) {
    throw SourceError(depth_file +
                      ": is the colour video and the depth video; name a grey video "
                      "of the depth (near is white) as the second one");
  }
  color_.file = openVideo(color_file);
  depth_.file = openVideo(depth_file);
  begin(fps);
}

VideoClip::VideoClip(std::unique_ptr<VideoFile> video, const VideoLayout& layout, double fps)
    : layout_(layout), color_{std::move(video)}, depth_(color_) {
  if (layout_.color_only) {
    color_.track = findColorTrack(color_.file->tracks(), color_.file->tracks().size());
    depth_ = color_;
  } else if (!hasHalves()) {
    chooseTracks();
  }
  info_.live = color_.file->isLive();
  skipped_ = SkippedFrames(info_.live);
  begin(fps);
}

void VideoClip::begin(double fps) {
  requireSizes();
  prepareRegistration();
  if (isPair()) choosePairing();
  startTracks();
  cv::Mat color;
  cv::Mat depth;
  while (color.empty() || (depth.empty() && !layout_.color_only)) {
    if (!grabFrame()) throwNoFrame(color_);
    cv::Mat next_color;
    cv::Mat next_depth;
    (void)retrieve(next_color, next_depth);
    if (color.empty()) color = next_color;
    if (depth.empty()) depth = next_depth;
  }
  if (hasDepthTrack()) requireDepthFormat(depth_.facts(), depth_.file->file());
  describe(color, depth, fps);
  if (camera_) info_.camera = scaleCamera(*camera_, info_);
  if (info_.live) return;
  if (by_time_) checkTimes();
  if (isPair() && !by_time_) warnOfOtherRate();
  info_.frame_count = countFrames();
  rewind();
  epoch_ = 0;
}

void VideoClip::describeColor(const cv::Mat& color, double fps) {
  color_size_ = color.size();
  info_.name = fileName(color_.file->file());
  setSize(info_, color_size_, color_.file->file());
  info_.fps = fps > 0.0 ? fps : nominalRate();
}

void VideoClip::describe(const cv::Mat& color, const cv::Mat& raw, double fps) {
  if (layout_.color_only) return describeColor(color, fps);
  const std::string& file = depth_.file->file();
  const FirstPictures first = describeFirst(color, raw, layout_.code, file);
  depth_size_ = first.depth_size;
  format_.kind = first.depth_kind;
  if (layout_.depth_unit_mm && (registration_ || layout_.code == DepthCode::kHue))
    throw SourceError(file + ": has depth in mm, so leave --depth-unit out");
  setDepthUnit(format_, layout_.depth_unit_mm, file);
  info_.mm_per_unit = format_.mm_per_unit;
  describeColor(color, fps);
  if (depth_size_ != color_size_) logScaledDepth(file, depth_size_, frameSize(info_));
  info_.depth_kind = format_.kind;
}

void VideoClip::chooseTracks() {
  const std::vector<VideoTrack>& tracks = color_.file->tracks();
  if (tracks.size() == 1) throwOneTrack();
  const auto depth = findDepthTrack(tracks);
  if (!depth) {
    throw SourceError(color_.file->file() + ": has " + std::to_string(tracks.size()) +
                      " video tracks, but it is not clear which one is the depth; name it (ffmpeg "
                      "-i FILE -map 0 -c copy -metadata:s:v:1 title=depth OUT.mkv)");
  }
  depth_.track = *depth;
  color_.track = findColorTrack(tracks, *depth);
}

void VideoClip::throwOneTrack() {
  VideoFile& video = *color_.file;
  video.start(0);
  cv::Mat picture;
  while (picture.empty() && video.grab(0)) picture = video.retrieveColor(0);
  const std::string guess = guessLayout(picture);
  if (!guess.empty()) throw SourceError(video.file() + ": has one video track; it " + guess);
  if (video.isLive()) {
    throw SourceError(
        video.file() +
        ": has one video track; depth is needed too, so send it as a second track, or "
        "use --layout if the picture shows both");
  }
  throw SourceError(video.file() +
                    ": is a single file with one video track; depth is needed too, so use "
                    "COLOR,DEPTH or a folder, --layout if the picture shows both, or --depth-from "
                    "with a program that estimates it");
}

void VideoClip::requireSizes() const {
  VideoTrack color = color_.facts();
  if (layout_.layout == Layout::kSideBySide) color.width_px /= 2;
  if (layout_.layout == Layout::kTopBottom) color.height_px /= 2;
  requireVideoSize(color, color_.file->file());
  if (hasDepthTrack()) requireVideoSize(depth_.facts(), depth_.file->file());
}

void VideoClip::prepareRegistration() {
  const VideoTrack& depth = depth_.facts();
  const VideoTrack& color = color_.facts();
  if (isPair() || !hasDepthTrack() || !depth.kinect_depth) return;
  const std::string& file = color_.file->file();
  const std::string text = color_.file->attachment("calibration.json");
  if (!text.empty()) {
    const KinectCalibration calibration =
        parseKinectCalibration(text, file + ": its calibration.json");
    const auto from = depthCamera(calibration, {depth.width_px, depth.height_px});
    const auto to = colorCamera(calibration, {color.width_px, color.height_px});
    if (from && to) {
      registration_.emplace(*from, *to, calibration);
      camera_ = CameraModel{to->matrix(0, 0), to->matrix(1, 1), to->matrix(0, 2) + 0.5,
                            to->matrix(1, 2) + 0.5};
      spdlog::info("{}: its depth is registered to its colour by the attached calibration", file);
      return;
    }
  }
  spdlog::warn(
      "--source {}: is a recording of an Azure Kinect or Orbbec {}; its depth is not aligned to "
      "its "
      "colour, so touch and picture do not match; align the depth to the colour first",
      file, text.empty() ? "without calibration" : "of sizes that its calibration does not know");
}

void VideoClip::choosePairing() {
  const auto readTimes = [](const VideoChannel& channel) {
    return describeTimes(VideoFile(channel.file->file()).readTimes(channel.track));
  };
  PairTimes times{readTimes(color_), readTimes(depth_)};
  if (belongByTime(times.color, times.depth)) {
    color_.start_s = times.color.start_s;
    depth_.start_s = times.depth.start_s;
    by_time_ = std::move(times);
    return;
  }
  const bool gaps = times.color.has_gaps || times.depth.has_gaps;
  if (!times.color.usable() || !times.depth.usable() || !gaps) return;
  spdlog::warn(
      "--source {}: has as many frames as the colour video, but other times ({:.2f} s, and the "
      "colour {:.2f} s); the server pairs frames by number, so make one anew with the times of the "
      "other if the depth does not fit",
      depth_.file->file(), times.depth.duration_s(), times.color.duration_s());
}

void VideoClip::checkTimes() const {
  const FrameTimes& color = by_time_->color;
  const FrameTimes& depth = by_time_->depth;
  const double most_s =
      static_cast<double>(kCountTolerance) * std::max(1.0 / color.fps, 1.0 / depth.fps);
  if (std::abs(color.duration_s() - depth.duration_s()) > most_s) {
    throw SourceError(fmt::format(
        "{}: lasts {:.2f} s, but the colour video lasts {:.2f} s; cut both to the same time",
        depth_.file->file(), depth.duration_s(), color.duration_s()));
  }
  const auto warn = [](const VideoChannel& channel, const char* missing, const LoneFrames& lone) {
    if (lone.count == 0) return;
    spdlog::warn("--source {}: has no {} for {} of its frames, the first at {:.3f} s",
                 channel.file->file(), missing, lone.count, lone.first_s);
  };
  warn(color_, "depth", findLone(color, depth));
  warn(depth_, "colour", findLone(depth, color));
}

double VideoClip::nominalRate() const {
  constexpr double kSameRate = 0.01;  // chosen: the file's exact rate, if frames have it
  const double stated = color_.facts().fps;
  if (by_time_) {
    const double fps = by_time_->color.fps;
    return std::abs(stated - fps) <= kSameRate * fps && plausibleRate(stated) == stated ? stated
                                                                                        : fps;
  }
  return plausibleRate(stated);
}

void VideoClip::warnOfOtherRate() const {
  constexpr double kSameRate = 0.01;  // chosen: 29.97 and 30 frames/s are one rate
  const double color = color_.facts().fps;
  const double depth = depth_.facts().fps;
  if (!(color >= 1.0 && depth >= 1.0) || std::abs(color - depth) <= kSameRate * color) return;
  spdlog::warn(
      "--source {}: has {:.4g} frames/s, but the colour video has {:.4g}; the server pairs frames "
      "by "
      "number, so convert one to the other's rate (ffmpeg -i FILE -vf fps={:.4g} OUT)",
      depth_.file->file(), depth, color, color);
}

std::optional<std::uint64_t> VideoClip::countFrames() const {
  if (by_time_) {
    const double last_s = std::min(by_time_->color.times_s.back(), by_time_->depth.times_s.back());
    return static_cast<std::uint64_t>(std::llround(last_s * nominalRate())) + 1;
  }
  const std::uint64_t colors = color_.facts().frame_count;
  const std::uint64_t depths = isPair() ? depth_.facts().frame_count : colors;
  if (colors == 0 || depths == 0) return std::nullopt;
  if (std::max(colors, depths) - std::min(colors, depths) > kCountTolerance) {
    throw SourceError(depth_.file->file() + ": has " + std::to_string(depths) +
                      " frames, but the colour video has " + std::to_string(colors) +
                      "; cut both to the same frames");
  }
  return std::min(colors, depths);
}

}  // namespace hapticast::server
