// SPDX-License-Identifier: MIT
#include "client/recording/recording_reader.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "common/protocol/recorded.hpp"

namespace hapticast::client {

namespace {

Result<AssembledFrame, WireError> decodeSentFrame(std::span<const std::uint8_t> bytes) {
  auto decoded = decodeFrameContent(bytes);
  if (!decoded.ok()) return decoded.error();
  AssembledFrame to;
  to.frame = std::move(decoded).value();
  to.place.epoch = to.frame.epoch;
  to.place.media_time = to.frame.media_time;
  return to;
}

template <auto decodeContent>
Result<RecordedContent> decodeAs(std::span<const std::uint8_t> bytes) {
  auto decoded = decodeContent(bytes);
  if (!decoded.ok()) return Error{decoded.error().message};
  return RecordedContent(std::move(decoded).value());
}

struct Decoder {
  const char* message;
  RecordedKind kind;
  const char* name;  // in problem()
  Result<RecordedContent> (*decode)(std::span<const std::uint8_t>);
};

constexpr std::array<Decoder, 7> kDecoders = {{
    {"hapticast.proto.HapticFrame", kFrameMessages, "frame", decodeAs<decodeSentFrame>},
    {"hapticast.proto.ReceivedFrame", kFrameMessages, "frame", decodeAs<decodeReceivedFrame>},
    {"hapticast.proto.Ticks", kTickMessages, "tick", decodeAs<decodeTicks>},
    {"foxglove.CompressedImage", kPictureMessages, "picture", decodeAs<decodePictureContent>},
    {"hapticast.proto.StreamDescription", kDescriptionMessages, "description",
     decodeAs<decodeDescriptionContent>},
    {"hapticast.proto.Timing", kTimingMessages, "timing", decodeAs<decodeTiming>},
    {"hapticast.proto.PreparedFrame", kPreparationMessages, "preparation",
     decodeAs<decodePreparation>},
}};

}  // namespace

Result<RecordingReader> RecordingReader::open(const std::string& file) {
  auto opened = McapReader::open(file);
  if (!opened.ok()) return opened.error();
  RecordingReader reader(std::move(opened).value());
  if (!reader.findChannels())
    return Error{
        "has no channel /frame or /tick of hapticast: it is no recording of hapticast-server or "
        "hapticast-client"};
  auto first = reader.file_.next();
  while (first && !reader.channels_.contains(first->channel)) first = reader.file_.next();
  if (!first) return Error{"has no messages: it " + reader.file_.problem()};
  reader.begin_ns_ = first->time_ns;
  reader.seek(0);
  return reader;
}

bool RecordingReader::findChannels() {
  bool is_of_server = false;
  for (const auto& [id, channel] : file_.channels()) {
    if (channel.message_encoding != "protobuf") continue;
    for (std::size_t i = 0; i < kDecoders.size(); ++i) {
      if (channel.schema.name != kDecoders[i].message) continue;
      channels_[id] = i;
      is_of_server = is_of_server || i == 0;
      is_of_client_ = is_of_client_ || kDecoders[i].kind == kTickMessages;
    }
  }
  return is_of_server || is_of_client_;
}

bool RecordingReader::has(RecordedKind kind) const {
  return std::any_of(channels_.begin(), channels_.end(),
                     [kind](const auto& each) { return kDecoders[each.second].kind == kind; });
}

std::optional<RecordedMessage> RecordingReader::next(unsigned kinds) {
  while (problem_.empty()) {
    const auto message = file_.next();
    if (!message) {
      problem_ = file_.problem();
      return std::nullopt;
    }
    const auto channel = channels_.find(message->channel);
    if (channel == channels_.end() || (kDecoders[channel->second].kind & kinds) == 0) continue;
    const Decoder& decoder = kDecoders[channel->second];
    auto decoded = decoder.decode(message->data);
    if (!decoded.ok()) {
      problem_ =
          std::string("has an invalid ") + decoder.name + " (" + decoded.error().message + ")";
      return std::nullopt;
    }
    const auto* const frame = std::get_if<AssembledFrame>(&decoded.value());
    if (frame != nullptr && !is_of_client_ && !rises(*frame)) continue;
    return RecordedMessage{message->time_ns, message->data.size(), std::move(decoded).value()};
  }
  return std::nullopt;
}

bool RecordingReader::rises(const AssembledFrame& frame) {
  if (last_ && frame.frame.media_time <= *last_) return false;
  last_ = frame.frame.media_time;
  return true;
}

void RecordingReader::seek(std::uint64_t time_ns) {
  file_.seek(time_ns);
  last_.reset();
  problem_.clear();
}

}  // namespace hapticast::client
