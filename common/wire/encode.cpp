// SPDX-License-Identifier: MIT
// Domain structs -> protobuf bytes (the other direction: wire.cpp).
#include "common/wire/messages.hpp"

#include <google/protobuf/stubs/common.h>

#include "common/wire/limits.hpp"
#include "hapticast.pb.h"

namespace hapticast {

namespace {

/// At most `limit` bytes of valid UTF-8 without control characters; what is not becomes '?'.
std::string printable(const std::string& text, std::size_t limit) {
  std::string clean;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80 ? 1 : lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    const std::string character = text.substr(i, length);
    const bool control = lead < 0x20 || lead == 0x7F;
    const bool valid = google::protobuf::internal::IsStructurallyValidUTF8(character);
    const std::string& put = valid && !control ? character : "?";
    if (clean.size() + put.size() > limit) break;
    clean += put;
    i += valid ? character.size() : 1;
  }
  return clean;
}

void write(const Vec3& from, proto::Vec3& to) {
  to.set_x(static_cast<float>(from.x()));
  to.set_y(static_cast<float>(from.y()));
  to.set_z(static_cast<float>(from.z()));
}

void write(const Hello& from, proto::Message& message) {
  auto& to = *message.mutable_hello();
  to.set_protocol_version(from.protocol_version);
  to.set_client_name(printable(from.client_name, limits::kClientName));
  to.set_wants_video(from.wants_video);
  to.set_wants_frames_on_tcp(from.wants_frames_on_tcp);
}

void write(const StreamDescription& from, proto::StreamDescription& to) {
  to.set_name(printable(from.name, limits::kStreamName));
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
}

void write(const Ping& from, proto::Message& message) {
  message.mutable_ping()->set_t0_ns(from.t0.time_since_epoch().count());
}

void write(const Pong& from, proto::Message& message) {
  auto& to = *message.mutable_pong();
  to.set_t0_ns(from.t0.time_since_epoch().count());
  to.set_t1_ns(from.t1.time_since_epoch().count());
  to.set_t2_ns(from.t2.time_since_epoch().count());
}

void write(const CodedRelief& from, proto::Relief& to) {
  to.set_u(static_cast<std::uint32_t>(from.rect.u));
  to.set_v(static_cast<std::uint32_t>(from.rect.v));
  to.set_width(static_cast<std::uint32_t>(from.rect.width));
  to.set_height(static_cast<std::uint32_t>(from.rect.height));
  for (const SliceBytes& slice : from.slices) to.add_slices(slice.data(), slice.size());
}

void write(const MotionGrid& from, proto::MotionGrid& to) {
  to.set_columns(static_cast<std::uint32_t>(from.columns));
  to.set_rows(static_cast<std::uint32_t>(from.rows));
  for (const auto& v : from.velocity_mm_s) to.mutable_velocity_mm_s()->Add(v.begin(), v.end());
  for (const auto& a : from.acceleration_mm_s2) {
    to.mutable_acceleration_mm_s2()->Add(a.begin(), a.end());
  }
}

void write(const Motion& from, proto::Motion& to) {
  write(from.position_mm, *to.mutable_position_mm());
  write(from.velocity_mm_s, *to.mutable_velocity_mm_s());
  write(from.acceleration_mm_s2, *to.mutable_acceleration_mm_s2());
  to.set_angle_rad(static_cast<float>(from.angle_rad));
  to.set_angular_velocity_rad_s(static_cast<float>(from.angular_velocity_rad_s));
  to.set_reference_point(static_cast<proto::ReferencePoint>(from.reference_point));
  to.set_quality(static_cast<float>(from.quality));
  to.set_visible_fraction(static_cast<float>(from.visible_fraction));
}

void write(const Material& from, proto::Material& to) {
  const auto given = [](const std::optional<double>& value) { return static_cast<float>(*value); };
  if (from.stiffness_N_mm) to.set_stiffness_n_mm(given(from.stiffness_N_mm));
  if (from.damping_Ns_m) to.set_damping_ns_m(given(from.damping_Ns_m));
  if (from.static_friction) to.set_static_friction(given(from.static_friction));
  if (from.dynamic_friction) to.set_dynamic_friction(given(from.dynamic_friction));
  if (from.texture_K_mm) to.set_texture_k_mm(given(from.texture_K_mm));
}

void write(const CodedFrame& from, proto::Message& message) {
  auto& to = *message.mutable_frame();
  to.set_epoch(from.epoch);
  to.set_id(from.id);
  to.set_media_time_ns(from.media_time.time_since_epoch().count());
  for (const CodedObject& object : from.objects) {
    auto& out = *to.add_objects();
    out.set_id(object.id);
    out.set_layer(object.layer);
    out.set_changed_in_frame(object.changed_in_frame);
    if (object.relief) write(*object.relief, *out.mutable_relief());
    write(object.motion, *out.mutable_motion());
    if (object.grid) write(*object.grid, *out.mutable_motion()->mutable_grid());
    for (const Impact& impact : object.impacts) {
      auto& hit = *out.add_impacts();
      hit.set_time_ns(impact.time.time_since_epoch().count());
      write(impact.delta_velocity_mm_s, *hit.mutable_delta_velocity_mm_s());
    }
    if (object.material != Material{}) write(object.material, *out.mutable_material());
  }
}

void write(const VideoFrame& from, proto::Message& message) {
  auto& to = *message.mutable_video();
  to.set_epoch(from.epoch);
  to.set_id(from.id);
  to.set_media_time_ns(from.media_time.time_since_epoch().count());
  to.set_jpeg(from.jpeg.data(), from.jpeg.size());
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
  message.mutable_error()->set_message(printable(from.message, limits::kErrorText));
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
