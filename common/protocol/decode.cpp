// SPDX-License-Identifier: MIT
// Decoder: protobuf bytes to domain structs, with every number checked (encoder: encode.cpp).
// Thread: any.
#include "common/protocol/messages.hpp"

#include <utility>
#ifndef __wasm__  // which has client/web/messages in place of libprotobuf
#include <google/protobuf/stubs/logging.h>
#endif

#include "common/protocol/check.hpp"
#include "common/protocol/read_frame.hpp"
#include "common/text.hpp"
#include "common/transport/framing.hpp"
#include "common/wire_limits.hpp"
#include "hapticast.pb.h"

namespace hapticast {

namespace {

#ifndef __wasm__
// Bytes from a peer must not cause output of protobuf on standard error.
const google::protobuf::LogSilencer kSilence;
#endif

/// Returns `from` clean for logs and screens.
std::string text(const std::string& from, std::size_t limit, Check& check) {
  check.bound(from.size(), limit, "a text is too long");
  return check.error() ? std::string() : sanitizeUtf8(from);
}

std::string token(const std::string& from, Check& check) {
  check.bound(from.size(), limits::kAccessToken, "an access token is too long");
  return check.error() ? std::string() : from;
}

Hello read(const proto::Hello& from, Check& check) {
  return {from.protocol_version(),
          text(from.client_name(), limits::kClientName, check),
          from.wants_video(),
          from.wants_frames_on_tcp(),
          token(from.access_token(), check),
          from.accepts_picture_parts(),
          from.wants_acts()};
}

DatagramKey read(const proto::DatagramKey& from, Check& check) {
  DatagramKey to;
  check.require(from.id() >= 1 && from.id() <= 255, "a datagram key's id is not 1..255");
  check.require(from.key().size() == to.bytes.size(), "a datagram key is not 16 bytes");
  check.require(from.grace_ms() <= limits::kKeyGrace_ms, "a key's grace is not 0..60 s");
  if (check.error()) return to;
  to.id = static_cast<std::uint8_t>(from.id());
  std::copy(from.key().begin(), from.key().end(), to.bytes.begin());
  to.grace = std::chrono::milliseconds(from.grace_ms());
  return to;
}

Control read(const proto::Control& from, Check& check) {
  Control to;
  if (from.has_paused()) to.paused = from.paused();
  if (from.has_seek_s())
    to.seek_s = check.number(from.seek_s(), 0.0, limits::kClip_s, "a seek is not 0..1e6 s");
  if (from.has_speed()) {
    to.speed = check.number(from.speed(), limits::kLeastSpeed, limits::kMostSpeed,
                            "a speed is not 0.1..4");
  }
  if (from.has_material()) to.material = readMaterial(from.material(), check);
  if (from.has_viewers()) to.viewers = from.viewers();
  to.operator_name = text(from.operator_name(), limits::kClientName, check);
  if (from.has_at_ns()) to.at = MediaTime(check.time(from.at_ns()));
  return to;
}

Timeline read(const proto::Timeline& from, Check& check) {
  Timeline to;
  to.length_s = check.number(from.length_s(), 0.0, limits::kClip_s, "the length is not 0..1e6 s");
  to.position_s = check.number(from.position_s(), 0.0, to.length_s, "the place is not 0..length");
  to.at = MediaTime(check.time(from.media_time_ns()));
  if (from.speed() != 0.0) {
    check.number(from.speed(), limits::kLeastSpeed, limits::kMostSpeed,
                 "the speed is neither 0 nor 0.1..4");
  }
  to.speed = from.speed();
  return to;
}

StreamDescription read(const proto::StreamDescription& from, Check& check) {
  StreamDescription to;
  to.name = text(from.name(), limits::kStreamName, check);
  check.require(from.width_px() >= 1 && from.width_px() <= static_cast<unsigned>(kMaxWidth_px) &&
                    from.height_px() >= 1 &&
                    from.height_px() <= static_cast<unsigned>(kMaxHeight_px),
                "the picture's size is out of range");
  to.workspace.width_px = static_cast<int>(from.width_px());
  to.workspace.height_px = static_cast<int>(from.height_px());
  to.fps = check.number(from.fps(), limits::kMinFps, limits::kMaxFps, "fps is not 1..240");
  const auto side = [&](double mm) {
    return check.number(mm, 1.0, limits::kWorkspace_mm, "the workspace is not 1..1000 mm");
  };
  to.workspace.width_mm = side(from.workspace_width_mm());
  to.workspace.height_mm = side(from.workspace_height_mm());
  to.workspace.depth_mm = side(from.workspace_depth_mm());
  to.workspace.stretch = from.stretch();
  check.require(proto::Method_IsValid(from.method()), "an unknown method");
  to.method = static_cast<Method>(from.method());
  check.require(
      from.pipeline_latency_ns() >= 0 && from.pipeline_latency_ns() <= limits::kLatency_ns,
      "the pipeline's latency is not 0..10 s");
  to.pipeline_latency = Duration(from.pipeline_latency_ns());
  to.largest_acceleration_mm_s2 =
      check.number(from.largest_acceleration_mm_s2(), 0.0, limits::kAcceleration_mm_s2,
                   "the largest acceleration is out of range");
  if (from.has_mass_kg()) {
    to.mass_kg = check.number(from.mass_kg(), limits::kMinMass_kg, limits::kMass_kg,
                              "the mass is not 1e-6..1000 kg");
  }
  if (from.has_timeline()) to.timeline = read(from.timeline(), check);
  return to;
}

std::uint16_t port(std::uint32_t from, Check& check) {
  check.require(from <= 65'535, "a port is not 0..65535");
  return static_cast<std::uint16_t>(from);
}

Welcome read(const proto::Welcome& from, Check& check) {
  Welcome to{from.protocol_version(), from.session_id(), from.datagram_token(),
             read(from.description(), check)};
  to.datagram_port = port(from.datagram_port(), check);
  to.stream = from.stream();
  check.require(from.verifying_key().size() == kKeyBytes ||
                    (from.verifying_key().empty() && to.datagram_token == 0),
                "a verifying key is not 32 bytes");
  if (check.error()) return to;
  if (!from.verifying_key().empty()) {
    to.verifying_key.emplace();
    std::copy(from.verifying_key().begin(), from.verifying_key().end(), to.verifying_key->begin());
  }
  if (from.has_datagram_key()) to.datagram_key = read(from.datagram_key(), check);
  if (from.has_group()) {
    check.require(to.datagram_token != 0 && from.group().port() != 0, "a group without a port");
    to.group = DatagramGroup{text(from.group().address(), limits::kGroupAddress, check),
                             port(from.group().port(), check), from.group().token()};
  }
  return to;
}

Delivery read(const proto::Delivery& from, Check& check) {
  check.require(from.copies() >= 1 && from.copies() <= limits::kMostCopies,
                "a number of copies is not 1..4");
  Delivery to{from.on_tcp(), from.datagrams(), from.copies()};
  if (from.has_pictures()) to.pictures = from.pictures();
  return to;
}

Ping read(const proto::Ping& from, Check& check) { return {LocalTime(check.time(from.t0_ns()))}; }

Pong read(const proto::Pong& from, Check& check) {
  check.require(from.error_ns() >= 0 && from.error_ns() <= limits::kClockError_ns,
                "a clock's error is not 0..10 s");
  return {LocalTime(check.time(from.t0_ns())), MediaTime(check.time(from.t1_ns())),
          MediaTime(check.time(from.t2_ns())), Duration(from.error_ns())};
}

VideoFrame read(const proto::VideoFrame& from, Check& check) {
  check.bound(from.jpeg().size(), limits::kJpeg, "a picture is larger than 4 MiB");
  const bool jpeg = from.jpeg().starts_with("\xFF\xD8");
  check.require(jpeg, "a picture is not a JPEG");
  VideoFrame to{from.epoch(), from.id(), MediaTime(check.time(from.media_time_ns())), {}};
  if (!check.error()) to.jpeg.assign(from.jpeg().begin(), from.jpeg().end());
  return to;
}

PicturePart read(const proto::PicturePart& from, Check& check) {
  check.bound(from.size(), limits::kPictureMessage, "a picture is larger than 4 MiB");
  check.bound(from.data().size(), limits::kPicturePart, "a part of a picture is too large");
  check.require(!from.data().empty(), "a part of a picture is empty");
  PicturePart to{from.size(), {}, from.reduced()};
  if (!check.error()) to.data.assign(from.data().begin(), from.data().end());
  return to;
}

Receipt read(const proto::Receipt& from, Check& check) {
  check.require(from.held_us() <= limits::kReceiptHeld_us, "a receipt was held for too long");
  return {from.bytes(), std::chrono::microseconds(from.held_us())};
}

ReceiverReport read(const proto::Report& from, Check& check) {
  constexpr double kLargest = 1e9;
  return {from.frames_received(),
          from.frames_lost(),
          from.frames_late(),
          check.number(from.playout_delay_ms(), 0.0, kLargest, "a report is out of range"),
          check.number(from.clock_error_us(), 0.0, kLargest, "a report is out of range"),
          from.in_contact()};
}

WireError read(const proto::Error& from, Check& check) {
  check.require(from.code() >= static_cast<unsigned>(ErrorCode::kMalformed) &&
                    from.code() <= static_cast<unsigned>(ErrorCode::kForbidden),
                "an unknown error code");
  return {static_cast<ErrorCode>(from.code()), text(from.message(), limits::kErrorText, check)};
}

Preparing read(const proto::Preparing& from, Check& check) {
  return {check.number(from.share(), 0.0, 1.0, "a share is out of range")};
}

Message readContent(const proto::Message& from, Check& check) {
  switch (from.content_case()) {
    case proto::Message::kHello:
      return read(from.hello(), check);
    case proto::Message::kWelcome:
      return read(from.welcome(), check);
    case proto::Message::kPing:
      return read(from.ping(), check);
    case proto::Message::kPong:
      return read(from.pong(), check);
    case proto::Message::kDescription:
      return read(from.description(), check);
    case proto::Message::kFrame:
      return readFrame(from.frame(), check);
    case proto::Message::kVideo:
      return read(from.video(), check);
    case proto::Message::kReport:
      return read(from.report(), check);
    case proto::Message::kError:
      return read(from.error(), check);
    case proto::Message::kPreparing:
      return read(from.preparing(), check);
    case proto::Message::kDelivery:
      return read(from.delivery(), check);
    case proto::Message::kDatagramKey:
      return read(from.datagram_key(), check);
    case proto::Message::kControl:
      return read(from.control(), check);
    case proto::Message::kPicturePart:
      return read(from.picture_part(), check);
    case proto::Message::kReceipt:
      return read(from.receipt(), check);
    case proto::Message::CONTENT_NOT_SET:
      break;
  }
  check.require(false, "a message without content");
  return Ping{};
}

}  // namespace

Result<Message, WireError> decode(std::span<const std::uint8_t> bytes) {
  Check check;
  check.bound(bytes.size(), kMaxMessageBytes, "a message is larger than 8 MiB");
  if (!check.error()) boundCounts(bytes, check);
  proto::Message parsed;
  if (!check.error()) {
    check.require(parsed.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())),
                  "bytes that are not a message");
  }
  if (check.error()) return *check.error();
  check.require(parsed.signature().empty() || parsed.signature().size() == kSignatureBytes,
                "a signature is not 64 bytes");
  Message message = readContent(parsed, check);
  if (check.error()) return *check.error();
  return message;
}

}  // namespace hapticast
