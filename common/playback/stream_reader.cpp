// SPDX-License-Identifier: MIT
#include "common/playback/stream_reader.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>

#include "common/protocol/recorded.hpp"
#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

// The recorder repeats description and reliefs within a second; the rest is for late frames.
constexpr Duration kRepeatWithin = std::chrono::milliseconds(1500);
constexpr std::uint64_t kFirstStepBack_ns = 2'000'000'000;  // chosen: one or two chunks

/// Decodes a frame whose times have room for what playback adds to them.
Result<CodedFrame, WireError> decodePlayableFrame(std::span<const std::uint8_t> bytes) {
  auto decoded = decodeFrameContent(bytes);
  if (decoded.ok() &&
      std::abs(decoded.value().media_time.time_since_epoch().count()) > limits::kTime_ns / 2)
    return WireError{ErrorCode::kMalformed, "a time is out of range"};
  return decoded;
}

constexpr std::array<ContentType<RecordedItem>, 3> kTypes = {{
    {"hapticast.proto.HapticFrame", "frame", decodeAs<RecordedItem, decodePlayableFrame>},
    {"hapticast.proto.StreamDescription", "description",
     decodeAs<RecordedItem, decodeDescriptionContent>},
    {"foxglove.CompressedImage", "picture", decodeAs<RecordedItem, decodePictureContent>},
}};
constexpr unsigned kFrames = setOf(0), kDescriptions = setOf(1), kPictures = setOf(2);

}  // namespace

Result<StreamReader> StreamReader::open(const std::string& file, const ReadProgress& progress) {
  auto opened = TypedReader<RecordedItem>::open(file, kTypes, progress);
  if (!opened.ok()) return opened.error();
  StreamReader reader(std::move(opened).value());
  if (!reader.file_.has(kFrames))
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
  return reader.file_.makeLackError("frames");
}

Result<StreamReader> StreamReader::reopen() const {
  auto file = file_.reopen();
  if (!file.ok()) return file.error();
  StreamReader reader(std::move(file).value());
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
    while (const auto message = file_.next(kFrames)) last_ns = std::max(last_ns, message->time_ns);
    if (is_all) break;
  }
  return std::max(begin_, MediaTime(Duration(static_cast<std::int64_t>(
                              std::min<std::uint64_t>(last_ns, limits::kTime_ns)))));
}

std::optional<RecordedItem> StreamReader::next() {
  while (const auto message = file_.next(kFrames | kDescriptions | (from_ ? 0 : kPictures))) {
    auto item = file_.decode(*message);
    if (!item || accept(*item)) return item;
  }
  return std::nullopt;
}

bool StreamReader::accept(RecordedItem& item) {
  if (auto* const frame = std::get_if<CodedFrame>(&item)) return accept(*frame);
  const auto* const description = std::get_if<StreamDescription>(&item);
  return description == nullptr || std::exchange(description_, *description) != *description;
}

bool StreamReader::accept(CodedFrame& frame) {
  if (last_ && frame.media_time <= *last_) {
    ++left_out_;
    return false;
  }
  last_ = frame.media_time;
  complete(frame);
  if (from_ && frame.media_time < *from_) return false;
  from_.reset();
  return true;
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
  left_out_ = 0;
}

}  // namespace hapticast
