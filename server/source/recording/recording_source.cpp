// SPDX-License-Identifier: MIT
#include "server/source/recording/recording_source.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "common/recording/progress_log.hpp"
#include "common/text.hpp"
#include "server/source/scale/depth_scale.hpp"
#include "server/source/scale/picture_scale.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

McapReader openMcap(const std::string& file) {
  auto opened = McapReader::open(file, logScan(file));
  if (!opened.ok()) throw SourceError(file + ": " + opened.error().message);
  return std::move(opened).value();
}

/// Throws SourceError if the recording has a stream of hapticast and no images of depth.
void refuseOwnRecording(const McapReader& reader, const std::string& file) {
  for (const auto& [id, channel] : reader.channels()) {
    if (channel.schema.name != "hapticast.proto.HapticFrame") continue;
    throw SourceError(file +
                      ": is a recording of hapticast-server, which has no depth images; "
                      "hapticast-server --source FILE.mcap plays it");
  }
}

/// Warns if the images of both topics are seen from two cameras.
void warnOfOtherView(const TopicPair& topics, const std::string& file) {
  const std::string& color = topics.color->frame_id;
  const std::string& depth = topics.depth->frame_id;
  if (color.empty() || depth.empty() || color == depth) return;
  spdlog::warn(
      "--source {}: its depth is seen from {} and its colour from {}; if the depth is not aligned "
      "to the colour, touch and picture do not match, so record aligned depth",
      file, quote(depth), quote(color));
}

}  // namespace

bool isRecordingFile(const std::string& file) {
  if (hasEnding(file, ".mcap")) return true;
  std::array<char, kMcapMagic.size()> head{};
  std::ifstream(file, std::ios::binary).read(head.data(), std::ssize(head));
  return std::equal(
      head.begin(), head.end(), kMcapMagic.begin(),
      [](char byte, std::uint8_t magic) { return static_cast<std::uint8_t>(byte) == magic; });
}

std::string findBagFile(const std::string& folder) try {
  if (!fs::exists(fs::path(folder) / "metadata.yaml")) return "";
  std::vector<std::string> parts;
  std::string other;  // refused with its remedy (known_files.hpp)
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().string();
    if (hasEnding(file, ".mcap")) parts.push_back(file);
    if (hasEnding(file, ".db3") || hasEnding(file, ".mcap.zstd")) other = file;
  }
  if (parts.size() == 1) return parts.front();
  if (parts.size() > 1)
    throw SourceError(folder + ": is a bag of " + std::to_string(parts.size()) +
                      " MCAP files; name one of them, or join them (mcap merge FILE.mcap "
                      "FILE2.mcap -o WHOLE.mcap)");
  return other;
} catch (const fs::filesystem_error& error) {
  throw SourceError(folder + ": cannot be read (" + error.code().message() + ")");
}

RecordingSource::RecordingSource(const std::string& file, double fps, const VideoLayout& layout)
    : file_(file) {
  McapReader reader = openMcap(file);
  refuseOwnRecording(reader, file);
  const RecordingIndex index =
      indexRecording(reader, logProgress("reading the messages of " + file));
  const TopicPair topics = chooseTopics(index, layout.topics, file);
  if (!index.problem.empty())
    spdlog::warn("--source {}: {}; the server plays the images before that", file, index.problem);
  warnOfOtherView(topics, file);
  clip_ = pairImages(topics, file);
  color_ = openTrack(reader, *topics.color);
  depth_ = openTrack(reader, *topics.depth);
  describe(layout);
  spdlog::info("{}: colour is {} ({}), depth is {} ({})", file, topics.color->name,
               topics.color->encoding, topics.depth->name, topics.depth->encoding);
  info_.name = fileName(file);
  info_.fps = fps > 0.0 ? fps : clip_.fps;
  info_.frame_count = clip_.pairs.back().index + 1;
  if (const CameraMessage* const camera = findCamera(index, topics.color->name)) setCamera(*camera);
}

RecordingSource::Track RecordingSource::openTrack(const McapReader& reader,
                                                  const ImageTopic& topic) const {
  auto reopened = reader.reopen();
  if (!reopened.ok()) throw SourceError(file_ + ": " + reopened.error().message);
  return {std::move(reopened).value(), file_ + ": " + topic.name};
}

ImageResult RecordingSource::readAt(Track& track, McapPlace place,
                                    ImageResult (*decode)(const ImageMessage&)) {
  track.reader.seek(place);
  const auto message = track.reader.next();
  const auto type = message ? findType(track.reader.channels().at(message->channel)) : std::nullopt;
  if (!type || isCameraType(*type) || track.reader.place() != place)
    return {{}, "cannot be read any more"};
  const auto image = readImageMessage(*type, message->data);
  if (!image.ok()) return {{}, image.error().message};
  return decode(image.value());
}

void RecordingSource::describe(const VideoLayout& layout) {
  ImageResult color, depth;
  std::string problem;
  for (const RecordedPair& pair : clip_.pairs) {
    color = readAt(*color_, pair.color, &readColor);
    depth = readAt(*depth_, pair.depth, &readDepth);
    if (color.ok() && depth.ok()) break;
    if (problem.empty())
      problem =
          color.ok() ? depth_->name + ": " + depth.problem : color_->name + ": " + color.problem;
  }
  if (!color.ok() || !depth.ok())
    throw SourceError(problem + "; no frame after it can be used either");
  color_size_ = color.image.size();
  depth_size_ = depth.image.size();
  if (!isSameAspect(depth_size_, color_size_)) {
    throw SourceError(depth_->name + ": is " + sizeText(depth_size_.width, depth_size_.height) +
                      ", but the colour is " + sizeText(color_size_.width, color_size_.height) +
                      aspectRemedy(depth_size_, color_size_));
  }
  setSize(info_, color_size_, file_);
  if (depth_size_ != color_size_) logScaledDepth(depth_->name, depth_size_, frameSize(info_));
  constexpr double kMm_m = 1000.0;  // ROS: floats are metres, integers mm (REP 118)
  format_.mm_per_unit = layout.depth_unit_mm.value_or(depth.image.depth() == CV_32F ? kMm_m : 1.0);
  info_.mm_per_unit = format_.mm_per_unit;
}

void RecordingSource::setCamera(const CameraMessage& camera) {
  CameraModel model = camera.camera;
  if (sizeReadable(camera.width_px, camera.height_px)) {
    const cv::Size stated(static_cast<int>(camera.width_px), static_cast<int>(camera.height_px));
    if (!isSameAspect(stated, color_size_)) {
      spdlog::warn(
          "{}: has intrinsics for {}, so the server does not use them; --fov states the "
          "field of view",
          color_->name, sizeText(stated.width, stated.height));
      return;
    }
    // The pictures may be scaled (binning).
    const double u = static_cast<double>(color_size_.width) / stated.width;
    const double v = static_cast<double>(color_size_.height) / stated.height;
    model = {model.fx_px * u, model.fy_px * v, model.cx_px * u, model.cy_px * v};
  }
  info_.camera = scaleCamera(model, info_);
}

std::optional<RgbdFrame> RecordingSource::read() {
  const auto next = [this](RgbdFrame& frame) {
    frame.index = clip_.pairs[next_ - 1].index;
    frame.epoch = epoch_;
    frame.clip_time_s = static_cast<double>(frame.index) / info_.fps;
    return load(frame);
  };
  if (auto frame = skipped_.readNext([this] { return skip(); }, next)) {
    any_read_ = true;
    return frame;
  }
  if (!any_read_ && !skipped_.problem().empty()) {
    throw SourceError(skipped_.cancelRun() +
                      ", and no frame after it can be used either; put the file back");
  }
  skipped_.endRun();
  return std::nullopt;
}

bool RecordingSource::skip() {
  if (next_ >= clip_.pairs.size()) return false;
  ++next_;
  return true;
}

void RecordingSource::rewind() {
  next_ = 0;
  any_read_ = false;
  ++epoch_;
}

std::string RecordingSource::load(RgbdFrame& frame) {
  const RecordedPair& pair = clip_.pairs[next_ - 1];
  const auto checkSize = [](ImageResult& result, cv::Size size) {
    if (!result.ok() || result.image.size() == size) return;
    result.problem = "is " + sizeText(result.image.cols, result.image.rows) +
                     ", but the first picture is " + sizeText(size.width, size.height);
  };
  ImageResult color = readAt(*color_, pair.color, &readColor);
  checkSize(color, color_size_);
  if (!color.ok()) return color_->name + ": " + color.problem;
  ImageResult depth = readAt(*depth_, pair.depth, &readDepth);
  checkSize(depth, depth_size_);
  if (depth.ok()) depth = toDepth(depth.image, format_);
  if (!depth.ok()) return depth_->name + ": " + depth.problem;
  frame.color = scaleColor(color.image, frameSize(info_));
  frame.depth = scaleDepth(depth.image, format_.kind, frame.color);
  return "";
}

}  // namespace hapticast::server
