// SPDX-License-Identifier: MIT
// Encoder: domain structs to protobuf bytes (decoder: decode.cpp). Thread: any.
#include "common/protocol/messages.hpp"

#include "common/protocol/write_frame.hpp"
#include "common/text.hpp"
#include "common/wire_limits.hpp"
#include "hapticast.pb.h"

namespace hapticast {

namespace {

void write(const Hello& from, proto::Message& message) {
  auto& to = *message.mutable_hello();
  to.set_protocol_version(from.protocol_version);
  to.set_client_name(sanitizeUtf8(from.client_name, limits::kClientName));
  to.set_wants_video(from.wants_video);
  to.set_wants_frames_on_tcp(from.wants_frames_on_tcp);
  to.set_access_token(from.access_token);
  to.set_accepts_picture_parts(from.accepts_picture_parts);
  to.set_wants_acts(from.wants_acts);
}

void write(const DatagramKey& from, proto::DatagramKey& to) {
  to.set_id(from.id);
  to.set_key(from.bytes.data(), from.bytes.size());
  to.set_grace_ms(static_cast<std::uint32_t>(from.grace / std::chrono::milliseconds(1)));
}

void write(const DatagramKey& from, proto::Message& message) {
  write(from, *message.mutable_datagram_key());
}

void write(const Control& from, proto::Message& message) {
  auto& to = *message.mutable_control();
  if (from.paused) to.set_paused(*from.paused);
  if (from.seek_s) to.set_seek_s(*from.seek_s);
  if (from.speed) to.set_speed(*from.speed);
  if (from.material != Material{}) writeMaterial(from.material, *to.mutable_material());
  if (from.viewers) to.set_viewers(*from.viewers);
  to.set_operator_name(sanitizeUtf8(from.operator_name, limits::kClientName));
  if (from.at) to.set_at_ns(from.at->time_since_epoch().count());
}

void write(const StreamDescription& from, proto::StreamDescription& to) {
  to.set_name(sanitizeUtf8(from.name, limits::kStreamName));
  to.set_width_px(static_cast<std::uint32_t>(from.workspace.width_px));
  to.set_height_px(static_cast<std::uint32_t>(from.workspace.height_px));
  to.set_fps(from.fps);
  to.set_workspace_width_mm(from.workspace.width_mm);
  to.set_workspace_height_mm(from.workspace.height_mm);
  to.set_workspace_depth_mm(from.workspace.depth_mm);
  to.set_stretch(from.workspace.stretch);
  to.set_method(static_cast<proto::Method>(from.method));
  to.set_pipeline_latency_ns(from.pipeline_latency.count());
  to.set_largest_acceleration_mm_s2(from.largest_acceleration_mm_s2);
  if (from.mass_kg) to.set_mass_kg(*from.mass_kg);
  if (!from.timeline) return;
  proto::Timeline& timeline = *to.mutable_timeline();
  timeline.set_length_s(from.timeline->length_s);
  timeline.set_position_s(from.timeline->position_s);
  timeline.set_media_time_ns(from.timeline->at.time_since_epoch().count());
  timeline.set_speed(from.timeline->speed);
}

void write(const StreamDescription& from, proto::Message& message) {
  write(from, *message.mutable_description());
}

void write(const Welcome& from, proto::Message& message) {
  auto& to = *message.mutable_welcome();
  to.set_protocol_version(from.protocol_version);
  to.set_session_id(from.session_id);
  to.set_datagram_token(from.datagram_token);
  write(from.description, *to.mutable_description());
  to.set_datagram_port(from.datagram_port);
  to.set_stream(from.stream);
  if (from.verifying_key)
    to.set_verifying_key(from.verifying_key->data(), from.verifying_key->size());
  if (from.datagram_key) write(*from.datagram_key, *to.mutable_datagram_key());
  if (!from.group) return;
  to.mutable_group()->set_address(from.group->address);
  to.mutable_group()->set_port(from.group->port);
  to.mutable_group()->set_token(from.group->token);
}

void write(const Ping& from, proto::Message& message) {
  message.mutable_ping()->set_t0_ns(from.t0.time_since_epoch().count());
}

void write(const Pong& from, proto::Message& message) {
  auto& to = *message.mutable_pong();
  to.set_t0_ns(from.t0.time_since_epoch().count());
  to.set_t1_ns(from.t1.time_since_epoch().count());
  to.set_t2_ns(from.t2.time_since_epoch().count());
  to.set_error_ns(from.error.count());
}

void write(const CodedFrame& from, proto::Message& message) {
  writeFrame(from, *message.mutable_frame());
}

void write(const Delivery& from, proto::Message& message) {
  auto& to = *message.mutable_delivery();
  to.set_on_tcp(from.on_tcp);
  to.set_datagrams(from.datagrams);
  to.set_copies(from.copies);
  if (from.pictures) to.set_pictures(*from.pictures);
}

void write(const VideoFrame& from, proto::Message& message) {
  auto& to = *message.mutable_video();
  to.set_epoch(from.epoch);
  to.set_id(from.id);
  to.set_media_time_ns(from.media_time.time_since_epoch().count());
  to.set_jpeg(from.jpeg.data(), from.jpeg.size());
}

void write(const PicturePart& from, proto::Message& message) {
  auto& to = *message.mutable_picture_part();
  to.set_size(from.size);
  to.set_data(from.data.data(), from.data.size());
  to.set_reduced(from.reduced);
}

void write(const Receipt& from, proto::Message& message) {
  auto& to = *message.mutable_receipt();
  to.set_bytes(from.bytes);
  to.set_held_us(static_cast<std::uint32_t>(from.held / std::chrono::microseconds(1)));
}

void write(const ReceiverReport& from, proto::Message& message) {
  auto& to = *message.mutable_report();
  to.set_frames_received(from.frames_received);
  to.set_frames_lost(from.frames_lost);
  to.set_frames_late(from.frames_late);
  to.set_playout_delay_ms(static_cast<float>(from.playout_delay_ms));
  to.set_clock_error_us(static_cast<float>(from.clock_error_us));
  to.set_in_contact(from.in_contact);
}

void write(const WireError& from, proto::Message& message) {
  message.mutable_error()->set_code(static_cast<std::uint32_t>(from.code));
  message.mutable_error()->set_message(sanitizeUtf8(from.message, limits::kErrorText));
}

void write(const Preparing& from, proto::Message& message) {
  message.mutable_preparing()->set_share(static_cast<float>(from.share));
}

}  // namespace

std::vector<std::uint8_t> encode(const Message& message) {
  proto::Message content;
  std::visit([&](const auto& each) { write(each, content); }, message);
  std::vector<std::uint8_t> bytes(content.ByteSizeLong());
  content.SerializeWithCachedSizesToArray(bytes.data());
  return bytes;
}

SharedBytes encodeShared(const Message& message) {
  return std::make_shared<const std::vector<std::uint8_t>>(encode(message));
}

}  // namespace hapticast
