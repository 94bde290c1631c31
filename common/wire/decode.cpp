// SPDX-License-Identifier: MIT
// Protobuf bytes -> domain structs, with every number checked (the other direction: encode.cpp).
#include "common/wire/messages.hpp"

#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <utility>

#include "common/wire/check.hpp"
#include "common/wire/framing.hpp"
#include "common/wire/limits.hpp"
#include "common/wire/relief_bytes.hpp"
#include "common/wire/scan.hpp"
#include "hapticast.pb.h"

namespace hapticast {

namespace {

// Bytes from a peer must not make protobuf write to our standard error.
const google::protobuf::LogSilencer kSilence;

/// Texts end up in logs and on screens: control characters become '?'.
std::string text(const std::string& from, std::size_t limit, Check& check) {
  check.bound(from.size(), limit, "a text is too long");
  std::string clean = check.error() ? std::string() : from;
  const auto control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
  std::replace_if(clean.begin(), clean.end(), control, '?');
  return clean;
}

Vec3 read(const proto::Vec3& from, double limit, Check& check) {
  for (const float each : {from.x(), from.y(), from.z()})
    check.magnitude(each, limit, "a vector is out of range");
  return {from.x(), from.y(), from.z()};
}

Hello read(const proto::Hello& from, Check& check) {
  return {from.protocol_version(), text(from.client_name(), limits::kClientName, check),
          from.wants_video(), from.wants_frames_on_tcp()};
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
  return to;
}

Welcome read(const proto::Welcome& from, Check& check) {
  return {from.protocol_version(), from.session_id(), from.datagram_token(),
          read(from.description(), check)};
}

Ping read(const proto::Ping& from, Check& check) { return {LocalTime(check.time(from.t0_ns()))}; }

Pong read(const proto::Pong& from, Check& check) {
  return {LocalTime(check.time(from.t0_ns())), MediaTime(check.time(from.t1_ns())),
          MediaTime(check.time(from.t2_ns()))};
}

Motion read(const proto::Motion& from, Check& check) {
  Motion to;
  to.position_mm = read(from.position_mm(), limits::kPosition_mm, check);
  to.velocity_mm_s = read(from.velocity_mm_s(), limits::kVelocity_mm_s, check);
  to.acceleration_mm_s2 = read(from.acceleration_mm_s2(), limits::kAcceleration_mm_s2, check);
  to.angle_rad = check.magnitude(from.angle_rad(), limits::kAngle_rad, "an angle is out of range");
  to.angular_velocity_rad_s =
      check.magnitude(from.angular_velocity_rad_s(), limits::kAngularVelocity_rad_s,
                      "an angular velocity is out of range");
  check.require(proto::ReferencePoint_IsValid(from.reference_point()),
                "an unknown reference point");
  to.reference_point = static_cast<ReferencePoint>(from.reference_point());
  to.quality = check.number(from.quality(), 0.0, 1.0, "a quality is not 0..1");
  to.visible_fraction =
      check.number(from.visible_fraction(), 0.0, 1.0, "a visible fraction is not 0..1");
  return to;
}

using Floats = google::protobuf::RepeatedField<float>;

std::vector<Eigen::Vector3f> vectors(const Floats& from, double limit, Check& check) {
  std::vector<Eigen::Vector3f> to(static_cast<std::size_t>(from.size()) / 3);
  for (int i = 0; i < from.size(); ++i) {
    to[static_cast<std::size_t>(i) / 3][i % 3] = from.Get(i);
    check.magnitude(from.Get(i), limit, "a grid's value is out of range");
  }
  return to;
}

std::shared_ptr<const MotionGrid> read(const proto::MotionGrid& from, const proto::Object& object,
                                       Check& check) {
  check.require(from.columns() >= 1 && from.columns() <= gridCells(unsigned{kMaxWidth_px}) &&
                    from.rows() >= 1 && from.rows() <= gridCells(unsigned{kMaxHeight_px}),
                "a grid's size is out of range");
  if (object.has_relief()) {
    check.require(from.columns() == gridCells(object.relief().width()) &&
                      from.rows() == gridCells(object.relief().height()),
                  "a grid does not cover its relief");
  }
  const auto values = 3ULL * from.columns() * from.rows();
  check.require(static_cast<unsigned>(from.velocity_mm_s_size()) == values &&
                    static_cast<unsigned>(from.acceleration_mm_s2_size()) == values,
                "a grid has the wrong number of values");
  if (check.error()) return nullptr;
  auto to = std::make_shared<MotionGrid>();
  to->columns = static_cast<int>(from.columns());
  to->rows = static_cast<int>(from.rows());
  to->velocity_mm_s = vectors(from.velocity_mm_s(), limits::kVelocity_mm_s, check);
  to->acceleration_mm_s2 = vectors(from.acceleration_mm_s2(), limits::kAcceleration_mm_s2, check);
  return to;
}

Material read(const proto::Material& from, Check& check) {
  const auto value = [&](bool given, float number, double limit) -> std::optional<double> {
    if (!given) return std::nullopt;
    return check.number(number, 0.0, limit, "a material's value is out of range");
  };
  return {
      value(from.has_stiffness_n_mm(), from.stiffness_n_mm(), limits::kStiffness_N_mm),
      value(from.has_damping_ns_m(), from.damping_ns_m(), limits::kDamping_Ns_m),
      value(from.has_static_friction(), from.static_friction(), limits::kFriction),
      value(from.has_dynamic_friction(), from.dynamic_friction(), limits::kFriction),
      value(from.has_texture_k_mm(), from.texture_k_mm(), limits::kWorkspace_mm),
  };
}

std::span<const std::uint8_t> bytesOf(const std::string& from) {
  return {reinterpret_cast<const std::uint8_t*>(from.data()), from.size()};
}

std::shared_ptr<const Relief> read(const proto::Relief& from, Check& check) {
  const PixelRect rect{static_cast<int>(from.u()), static_cast<int>(from.v()),
                       static_cast<int>(from.width()), static_cast<int>(from.height())};
  auto relief = unpackRelief(rect, {from.offset_mm(), from.scale_mm()}, bytesOf(from.mask()),
                             bytesOf(from.heights()));
  if (relief.ok()) return std::make_shared<const Relief>(std::move(relief).value());
  check.take(relief.error());
  return nullptr;
}

HapticObject read(const proto::Object& from, std::uint64_t frame_id, Check& check) {
  HapticObject to;
  to.id = from.id();
  to.layer = from.layer();
  check.require(to.layer < kMaxObjects, "a layer is not 0..15");
  to.changed_in_frame = from.changed_in_frame();
  check.require(to.changed_in_frame <= frame_id, "a relief changed in a later frame");
  to.motion = read(from.motion(), check);
  if (from.motion().has_grid()) to.grid = read(from.motion().grid(), from, check);
  check.bound(static_cast<std::size_t>(from.impacts_size()), kMaxImpacts, "too many impacts");
  if (check.error()) return to;
  for (const proto::Impact& impact : from.impacts()) {
    to.impacts.push_back({MediaTime(check.time(impact.time_ns())),
                          read(impact.delta_velocity_mm_s(), limits::kVelocity_mm_s, check)});
  }
  if (from.has_material()) to.material = read(from.material(), check);
  if (from.has_relief() && !check.error()) to.relief = read(from.relief(), check);
  return to;
}

HapticFrame read(const proto::HapticFrame& from, Check& check) {
  HapticFrame to;
  to.epoch = from.epoch();
  to.id = from.id();
  to.media_time = MediaTime(check.time(from.media_time_ns()));
  check.bound(static_cast<std::size_t>(from.objects_size()), kMaxObjects, "too many objects");
  std::uint64_t pixels = 0;
  for (const proto::Object& object : from.objects()) {
    pixels += static_cast<std::uint64_t>(object.relief().width()) * object.relief().height();
    check.bound(pixels, kMaxReliefPixels, "the reliefs of a frame cover too many pixels");
    if (check.error()) break;
    to.objects.push_back(read(object, to.id, check));
    for (std::size_t i = 0; i + 1 < to.objects.size(); ++i) {
      check.require(to.objects[i].id != object.id() || to.objects[i].layer != object.layer(),
                    "an object appears twice");
    }
  }
  return to;
}

VideoFrame read(const proto::VideoFrame& from, Check& check) {
  check.bound(from.jpeg().size(), limits::kJpeg, "a picture is larger than 4 MiB");
  const bool jpeg = from.jpeg().starts_with("\xFF\xD8");
  check.require(jpeg, "a picture is not a JPEG");
  VideoFrame to{from.epoch(), from.id(), MediaTime(check.time(from.media_time_ns())), {}};
  if (!check.error()) to.jpeg.assign(from.jpeg().begin(), from.jpeg().end());
  return to;
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
                    from.code() <= static_cast<unsigned>(ErrorCode::kShuttingDown),
                "an unknown error code");
  return {static_cast<ErrorCode>(from.code()), text(from.message(), limits::kErrorText, check)};
}

Preparing read(const proto::Preparing& from, Check& check) {
  return {check.number(from.share(), 0.0, 1.0, "a share is out of range")};
}

/// Counts what may repeat before the parser allocates it.
void checkCounts(std::span<const std::uint8_t> bytes, Check& check) {
  const auto frames = submessages(bytes, proto::Message::kFrameFieldNumber, 1);
  check.require(frames.has_value(), "more than one frame in a message");
  if (!frames || frames->empty()) return;
  const auto objects =
      submessages(frames->front(), proto::HapticFrame::kObjectsFieldNumber, kMaxObjects);
  check.bound(objects ? objects->size() : kMaxObjects + 1, kMaxObjects, "too many objects");
  if (!objects) return;
  for (const auto object : *objects) {
    const auto impacts = submessages(object, proto::Object::kImpactsFieldNumber, kMaxImpacts);
    check.bound(impacts ? impacts->size() : kMaxImpacts + 1, kMaxImpacts, "too many impacts");
  }
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
      return read(from.frame(), check);
    case proto::Message::kVideo:
      return read(from.video(), check);
    case proto::Message::kReport:
      return read(from.report(), check);
    case proto::Message::kError:
      return read(from.error(), check);
    case proto::Message::kPreparing:
      return read(from.preparing(), check);
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
  if (!check.error()) checkCounts(bytes, check);
  proto::Message parsed;
  if (!check.error()) {
    check.require(parsed.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())),
                  "bytes that are not a message");
  }
  if (check.error()) return *check.error();
  Message message = readContent(parsed, check);
  if (check.error()) return *check.error();
  return message;
}

}  // namespace hapticast
