// SPDX-License-Identifier: MIT
#include "common/playback/stream_reader.hpp"

#include <algorithm>
#include <cstdlib>

#include "common/protocol/recorded.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

// The recorder repeats description and reliefs within a second; the rest is for late frames.
constexpr Duration kRepeatWithin = std::chrono::milliseconds(1500);
constexpr std::uint64_t kFirstStepBack_ns = 2'000'000'000;  // chosen: one or two chunks

}  // namespace

Result<StreamReader> StreamReader::open(const std::string& file) {
  auto opened = McapReader::open(file);
  if (!opened.ok()) return opened.error();
  StreamReader reader(std::move(opened).value());
  if (!reader.findChannels())
    return Error{"has no channel /frame of hapticast: it is no recording of hapticast-server"};
  while (const auto item = reader.next()) {
    const auto* const frame = std::get_if<CodedFrame>(&*item);
    if (frame == nullptr) continue;
    if (!reader.description_) return Error{"has no description of the stream before its frames"};
    reader.begin_ = frame->media_time;
    reader.first_description_ = *reader.description_;
    reader.end_ = reader.findEnd();
    reader.seek(reader.begin_);
    return reader;
  }
  const std::string& problem = reader.problem();
  return Error{problem.empty() ? "has no frames" : "has no frames: it " + problem};
}

bool StreamReader::findChannels() {
  for (const auto& [id, channel] : file_.channels()) {
    if (channel.message_encoding != "protobuf") continue;
    if (channel.schema.name == "hapticast.proto.HapticFrame") frames_ = id;
    if (channel.schema.name == "hapticast.proto.StreamDescription") descriptions_ = id;
    if (channel.schema.name == "foxglove.CompressedImage") pictures_ = id;
  }
  return frames_.has_value();
}

Result<StreamReader> StreamReader::reopen() const {
  auto file = file_.reopen();
  if (!file.ok()) return file.error();
  StreamReader reader(std::move(file).value());
  (void)reader.findChannels();
  reader.first_description_ = first_description_;
  reader.begin_ = begin_;
  reader.end_ = end_;
  reader.seek(begin_);
  return reader;
}

MediaTime StreamReader::findEnd() {
  const auto begin_ns =
      static_cast<std::uint64_t>(std::max<std::int64_t>(begin_.time_since_epoch().count(), 0));
  std::uint64_t last_ns = begin_ns;
  // Usually the last chunk has a frame; the file may go on without, for example with the log.
  for (std::uint64_t back_ns = kFirstStepBack_ns; last_ns == begin_ns; back_ns *= 4) {
    const std::uint64_t end_ns = std::min<std::uint64_t>(file_.end_ns(), limits::kTime_ns);
    const bool is_all = back_ns >= end_ns || end_ns - back_ns <= begin_ns;
    file_.seek(is_all ? begin_ns : end_ns - back_ns);
    while (const auto message = file_.next())
      if (message->channel == frames_) last_ns = std::max(last_ns, message->time_ns);
    if (is_all) break;
  }
  return std::max(begin_, MediaTime(Duration(static_cast<std::int64_t>(
                              std::min<std::uint64_t>(last_ns, limits::kTime_ns)))));
}

std::optional<RecordedItem> StreamReader::next() {
  while (problem_.empty()) {
    const auto message = file_.next();
    if (!message) {
      problem_ = file_.problem();
      return std::nullopt;
    }
    if (auto item = read(*message)) return item;
  }
  return std::nullopt;
}

std::optional<RecordedItem> StreamReader::read(const McapMessage& message) {
  if (message.channel == frames_) return readFrame(message.data);
  if (message.channel == descriptions_) {
    auto decoded = decodeDescriptionContent(message.data);
    if (!decoded.ok()) {
      problem_ = "has an invalid description (" + decoded.error().message + ")";
    } else if (description_ != decoded.value()) {
      description_ = std::move(decoded).value();
      return *description_;
    }
    return std::nullopt;
  }
  if (message.channel != pictures_ || from_) return std::nullopt;
  auto decoded = decodePictureContent(message.data);
  if (decoded.ok()) return std::move(decoded).value();
  problem_ = "has an invalid picture (" + decoded.error().message + ")";
  return std::nullopt;
}

std::optional<RecordedItem> StreamReader::readFrame(std::span<const std::uint8_t> data) {
  auto decoded = decodeFrameContent(data);
  if (!decoded.ok()) {
    problem_ = "has an invalid frame (" + decoded.error().message + ")";
    return std::nullopt;
  }
  CodedFrame& frame = decoded.value();
  // Room for what playback adds to the times.
  if (std::abs(frame.media_time.time_since_epoch().count()) > limits::kTime_ns / 2) {
    problem_ = "has an invalid frame (a time is out of range)";
    return std::nullopt;
  }
  if (last_ && frame.media_time <= *last_) {
    ++left_out_;
    return std::nullopt;
  }
  last_ = frame.media_time;
  complete(frame);
  if (from_ && frame.media_time < *from_) return std::nullopt;
  from_.reset();
  return std::move(frame);
}

void StreamReader::complete(CodedFrame& frame) {
  std::map<ObjectKey, Known> present;
  for (CodedObject& object : frame.objects) {
    const auto known = reliefs_.find(makeKey(object));
    if (!object.relief && known != reliefs_.end() &&
        known->second.changed_in_frame == object.changed_in_frame)
      object.relief = known->second.relief;
    if (object.relief) present[makeKey(object)] = {object.changed_in_frame, object.relief};
  }
  reliefs_ = std::move(present);
}

void StreamReader::seek(MediaTime time) {
  const std::int64_t from_ns =
      time <= begin_ ? 0 : (time - kRepeatWithin).time_since_epoch().count();
  file_.seek(static_cast<std::uint64_t>(std::max<std::int64_t>(from_ns, 0)));
  last_.reset();
  from_ = time;
  reliefs_.clear();
  problem_.clear();
  left_out_ = 0;
}

}  // namespace hapticast
