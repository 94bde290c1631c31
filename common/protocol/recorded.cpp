// SPDX-License-Identifier: MIT
#include "common/protocol/recorded.hpp"

#include <utility>

#include "common/protocol/check.hpp"
#include "common/protocol/scan.hpp"
#include "common/text.hpp"
#include "common/wire_limits.hpp"
#include "hapticast.pb.h"
#include "picture.pb.h"

namespace hapticast {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Decodes `content` as the field `field` of a message.
template <class Content>
Result<Content, WireError> decodeContent(std::uint32_t field,
                                         std::span<const std::uint8_t> content) {
  if (content.size() > kMaxMessageBytes)
    return WireError{ErrorCode::kTooLarge, "a message is larger than 8 MiB"};
  std::vector<std::uint8_t> message;
  message.reserve(content.size() + 8);
  message.push_back(static_cast<std::uint8_t>(field << 3U | 2U));  // a length and bytes
  for (std::size_t rest = content.size(); true; rest >>= 7U) {
    message.push_back(static_cast<std::uint8_t>((rest & 127U) | (rest > 127U ? 128U : 0U)));
    if (rest <= 127U) break;
  }
  message.insert(message.end(), content.begin(), content.end());
  auto decoded = decode(message);
  if (!decoded.ok()) return decoded.error();
  if (auto* const found = std::get_if<Content>(&decoded.value())) return std::move(*found);
  return WireError{ErrorCode::kMalformed, "a recorded message of another kind"};
}

/// Sets a Timestamp of protobuf, which has nanoseconds of 0 or more, also before its zero.
void setTime(proto::PictureTime& time, std::int64_t time_ns) {
  const std::int64_t nanos = ((time_ns % kSecond_ns) + kSecond_ns) % kSecond_ns;
  time.set_seconds((time_ns - nanos) / kSecond_ns);
  time.set_nanos(static_cast<std::int32_t>(nanos));
}

template <class ProtoMessage>
std::vector<std::uint8_t> toBytes(const ProtoMessage& message) {
  std::vector<std::uint8_t> bytes(message.ByteSizeLong());
  message.SerializeWithCachedSizesToArray(bytes.data());
  return bytes;
}

}  // namespace

std::span<const std::uint8_t> findContent(std::span<const std::uint8_t> message) {
  for (const int field :
       {proto::Message::kFrameFieldNumber, proto::Message::kDescriptionFieldNumber}) {
    const auto found = submessages(message, static_cast<std::uint32_t>(field), 1);
    if (found && !found->empty()) return found->front();
  }
  return {};
}

Result<CodedFrame, WireError> decodeFrameContent(std::span<const std::uint8_t> bytes) {
  return decodeContent<CodedFrame>(proto::Message::kFrameFieldNumber, bytes);
}

Result<StreamDescription, WireError> decodeDescriptionContent(std::span<const std::uint8_t> bytes) {
  return decodeContent<StreamDescription>(proto::Message::kDescriptionFieldNumber, bytes);
}

std::vector<std::uint8_t> encodePictureContent(const VideoFrame& video) {
  proto::Picture picture;
  setTime(*picture.mutable_timestamp(), video.media_time.time_since_epoch().count());
  picture.set_data(video.jpeg.data(), video.jpeg.size());
  picture.set_format("jpeg");
  picture.set_frame_id("camera");
  return toBytes(picture);
}

std::vector<std::uint8_t> encodeLogContent(std::uint64_t time_ns, LogLevel level,
                                           std::string_view text, std::string_view program) {
  proto::LogLine line;
  setTime(*line.mutable_timestamp(), static_cast<std::int64_t>(time_ns));
  line.set_level(static_cast<std::uint32_t>(level));
  line.set_message(sanitizeUtf8(text));
  line.set_name(program.data(), program.size());
  return toBytes(line);
}

Result<VideoFrame, WireError> decodePictureContent(std::span<const std::uint8_t> bytes) {
  Check check;
  check.bound(bytes.size(), kMaxMessageBytes, "a message is larger than 8 MiB");
  proto::Picture picture;
  if (!check.error())
    check.require(picture.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())),
                  "bytes that are not a picture");
  if (check.error()) return *check.error();
  check.bound(picture.data().size(), limits::kJpeg, "a picture is larger than 4 MiB");
  check.require(picture.data().starts_with("\xFF\xD8"), "a picture is not a JPEG");
  const auto& time = picture.timestamp();
  check.require(time.seconds() >= -limits::kTime_ns / kSecond_ns &&
                    time.seconds() < limits::kTime_ns / kSecond_ns && time.nanos() >= 0 &&
                    time.nanos() < kSecond_ns,
                "a picture's time is out of range");
  if (check.error()) return *check.error();
  const MediaTime at(Duration(time.seconds() * kSecond_ns + time.nanos()));
  return VideoFrame{0, 0, at, {picture.data().begin(), picture.data().end()}};
}

}  // namespace hapticast
