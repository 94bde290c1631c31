// SPDX-License-Identifier: MIT
#include "client/recording/recording_reader.hpp"

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

/// Returns the type of the messages of a channel of a run.
template <auto decodeContent>
constexpr ContentType<RecordedContent> makeType(RunChannel channel, const char* name) {
  return {kRunChannelNames[channel].message, name, decodeAs<RecordedContent, decodeContent>};
}

constexpr std::array<ContentType<RecordedContent>, kRunChannels + 1> kTypes = {{
    makeType<decodeSettings>(kSettingsChannel, "message of the settings"),
    makeType<decodeTicks>(kTickChannel, "tick"),
    makeType<decodeReceivedFrame>(kFrameChannel, "frame"),
    makeType<decodePreparation>(kPreparedChannel, "preparation"),
    makeType<decodeTiming>(kTimingChannel, "timing"),
    makeType<decodeControls>(kControlsChannel, "message of the controls"),
    makeType<decodeDescriptionContent>(kDescriptionChannel, "description"),
    makeType<decodePictureContent>(kPictureChannel, "picture"),
    {"hapticast.proto.HapticFrame", "frame", decodeAs<RecordedContent, decodeSentFrame>},
}};

}  // namespace

TypedReader<RecordedContent>::Types listRecordedTypes() { return kTypes; }

Result<RecordingReader> RecordingReader::open(const std::string& file) {
  auto opened = TypedReader<RecordedContent>::open(file, kTypes);
  if (!opened.ok()) return opened.error();
  RecordingReader reader(std::move(opened).value());
  if (!reader.has(kSentFrameMessages | kTickMessages))
    return Error{
        "has no channel /frame or /tick of hapticast: it is no recording of hapticast-server or "
        "hapticast-client"};
  const auto first = reader.file_.next(kStreamMessages);
  if (!first) return reader.file_.makeLackError("messages");
  reader.begin_ns_ = first->time_ns;
  reader.seek(0);
  return reader;
}

std::optional<RecordedMessage> RecordingReader::next(unsigned types) {
  while (const auto message = file_.next(types)) {
    auto content = file_.decode(*message);
    if (!content) break;
    const auto* const frame = std::get_if<AssembledFrame>(&*content);
    if (frame == nullptr || isOfClient() || rises(*frame))
      return RecordedMessage{message->time_ns, message->data.size(), std::move(*content)};
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
}

}  // namespace hapticast::client
