// SPDX-License-Identifier: MIT
#include "client/recording/run_codec.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "client/device/profile/device_profile.hpp"
#include "common/protocol/check.hpp"
#include "common/protocol/read_frame.hpp"
#include "common/protocol/write_frame.hpp"
#include "common/transport/framing.hpp"
#include "recording.pb.h"

namespace hapticast::client {

namespace {

// Ticks in one message; a message of this program has ten.
constexpr int kMostTicks = 1000;

template <class Message>
RecordedBytes serialize(const Message& message) {
  RecordedBytes bytes(message.ByteSizeLong());
  message.SerializeWithCachedSizesToArray(bytes.data());
  return bytes;
}

/// Parses `bytes` into `message`, or records an error in `check`.
template <class Message>
void parse(std::span<const std::uint8_t> bytes, Message& message, Check& check) {
  check.bound(bytes.size(), kMaxMessageBytes, "a message is larger than 8 MiB");
  if (check.error()) return;
  check.require(message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())),
                "bytes that are not a message");
}

void addVector(const Vec3& from, google::protobuf::RepeatedField<double>& to) {
  to.Add(from.begin(), from.end());
}

Vec3 readVector(const google::protobuf::RepeatedField<double>& from, int tick) {
  return {from[3 * tick], from[3 * tick + 1], from[3 * tick + 2]};
}

std::int64_t toNs(LocalTime time) { return time.time_since_epoch().count(); }

/// Returns whether each list of `from` has the right number of values.
bool isComplete(const proto::Ticks& from) {
  const int ticks = from.tick_size();
  const auto hasTicks = [ticks](const auto&... lists) { return ((lists.size() == ticks) && ...); };
  const auto hasVectors = [ticks](const auto&... lists) {
    return ((lists.size() == 3 * ticks) && ...);
  };
  return hasTicks(from.time_ns(), from.reading_time_ns(), from.buttons(), from.device(),
                  from.frames(), from.timing(), from.controls(), from.stopping(),
                  from.play_time_ns(), from.playout_delay_ns(), from.penetration_mm(),
                  from.contact(), from.lookup(), from.safety_actions(), from.fault()) &&
         hasVectors(from.reading_mm(), from.hip_mm(), from.force_n(), from.static_force_n(),
                    from.dynamic_force_n());
}

TickReport readTick(const proto::Ticks& from, int i, Check& check) {
  TickReport to;
  to.tick = from.tick(i);
  to.time = LocalTime(check.time(from.time_ns(i)));
  check.require(from.device(i) <= 2 && from.lookup(i) < kLookupKinds && from.fault(i) < kFaultKinds,
                "a tick has an unknown value");
  to.inputs.reading = {readVector(from.reading_mm(), i), from.buttons(i),
                       LocalTime(check.time(from.reading_time_ns(i))),
                       static_cast<DeviceStatus>(from.device(i))};
  to.inputs.frames = from.frames(i);
  to.inputs.timing = from.timing(i);
  to.inputs.controls = from.controls(i);
  to.inputs.stopping = from.stopping(i);
  to.play_time = MediaTime(Duration(from.play_time_ns(i)));
  to.playout_delay = Duration(from.playout_delay_ns(i));
  to.hip_mm = readVector(from.hip_mm(), i);
  to.force_N = readVector(from.force_n(), i);
  to.static_force_N = readVector(from.static_force_n(), i);
  to.dynamic_force_N = readVector(from.dynamic_force_n(), i);
  to.penetration_mm = from.penetration_mm(i);
  to.contact = from.contact(i);
  to.lookup = static_cast<Lookup>(from.lookup(i));
  to.safety_actions = from.safety_actions(i);
  to.fault = static_cast<Fault>(from.fault(i));
  return to;
}

}  // namespace

RecordedBytes encodeTicks(std::span<const TickReport> ticks) {
  proto::Ticks to;
  for (const TickReport& from : ticks) {
    const TickInputs& inputs = from.inputs;
    to.add_tick(from.tick);
    to.add_time_ns(toNs(from.time));
    addVector(inputs.reading.position_mm, *to.mutable_reading_mm());
    to.add_reading_time_ns(toNs(inputs.reading.time));
    to.add_buttons(inputs.reading.buttons);
    to.add_device(static_cast<std::uint32_t>(inputs.reading.status));
    to.add_frames(inputs.frames);
    to.add_timing(inputs.timing);
    to.add_controls(inputs.controls);
    to.add_stopping(inputs.stopping);
    to.add_play_time_ns(from.play_time.time_since_epoch().count());
    to.add_playout_delay_ns(from.playout_delay.count());
    addVector(from.hip_mm, *to.mutable_hip_mm());
    addVector(from.force_N, *to.mutable_force_n());
    addVector(from.static_force_N, *to.mutable_static_force_n());
    addVector(from.dynamic_force_N, *to.mutable_dynamic_force_n());
    to.add_penetration_mm(from.penetration_mm);
    to.add_contact(from.contact);
    to.add_lookup(static_cast<std::uint32_t>(from.lookup));
    to.add_safety_actions(from.safety_actions);
    to.add_fault(static_cast<std::uint32_t>(from.fault));
  }
  return serialize(to);
}

Result<std::vector<TickReport>> decodeTicks(std::span<const std::uint8_t> bytes) {
  Check check;
  proto::Ticks from;
  parse(bytes, from, check);
  check.require(from.tick_size() <= kMostTicks && isComplete(from),
                "ticks have lists of different lengths");
  std::vector<TickReport> ticks;
  if (!check.error()) ticks.reserve(static_cast<std::size_t>(from.tick_size()));
  for (int i = 0; i < from.tick_size() && !check.error(); ++i)
    ticks.push_back(readTick(from, i, check));
  if (check.error()) return Error{check.error()->message};
  return ticks;
}

RecordedBytes encodeFrame(const AssembledFrame& assembled) {
  proto::ReceivedFrame to;
  writeFrame(assembled.frame, *to.mutable_frame());
  for (std::size_t i = 0; i < assembled.frame.objects.size(); ++i) {
    const auto& relief = assembled.frame.objects[i].relief;
    auto& object = *to.mutable_frame()->mutable_objects(static_cast<int>(i));
    if (!relief) continue;
    object.mutable_relief()->set_slice_count(static_cast<std::uint32_t>(relief->slice_count));
  }
  to.set_client_epoch(assembled.place.epoch);
  to.set_resync(assembled.place.resync);
  return serialize(to);
}

Result<AssembledFrame> decodeReceivedFrame(std::span<const std::uint8_t> bytes) {
  Check check;
  check.bound(bytes.size(), kMaxMessageBytes, "a message is larger than 8 MiB");
  if (check.error()) return Error{check.error()->message};
  boundCountsOfContent(bytes, proto::ReceivedFrame::kFrameFieldNumber, check);
  proto::ReceivedFrame from;
  if (!check.error()) parse(bytes, from, check);
  if (check.error()) return Error{check.error()->message};
  AssembledFrame to;
  to.frame = readAssembledFrame(from.frame(), check);
  if (check.error()) return Error{check.error()->message};
  to.place.epoch = from.client_epoch();
  to.place.resync = from.resync();
  to.place.media_time = to.frame.media_time;
  return to;
}

RecordedBytes encodePreparation(const RecordedPreparation& preparation) {
  proto::PreparedFrame to;
  to.set_id(preparation.id);
  to.set_handed_over(preparation.handed_over);
  return serialize(to);
}

Result<RecordedPreparation> decodePreparation(std::span<const std::uint8_t> bytes) {
  Check check;
  proto::PreparedFrame from;
  parse(bytes, from, check);
  if (check.error()) return Error{check.error()->message};
  return RecordedPreparation{from.id(), from.handed_over()};
}

RecordedBytes encodeTiming(const RecordedTiming& recorded) {
  const StreamTiming& from = recorded.timing;
  proto::Timing to;
  to.set_number(from.number);
  to.set_connected(from.connected);
  to.set_first_epoch(from.first_epoch);
  to.set_clock_offset_ns(from.clock_offset.count());
  to.set_pipeline_latency_ns(from.pipeline_latency.count());
  to.set_playout_delay_target_ns(from.playout_delay_target.count());
  to.set_frame_interval_ns(from.frame_interval.count());
  to.set_width_px(static_cast<std::uint32_t>(from.workspace.width_px));
  to.set_height_px(static_cast<std::uint32_t>(from.workspace.height_px));
  to.set_workspace_width_mm(from.workspace.width_mm);
  to.set_workspace_height_mm(from.workspace.height_mm);
  to.set_workspace_depth_mm(from.workspace.depth_mm);
  to.set_stretch(from.workspace.stretch);
  to.set_largest_acceleration_mm_s2(from.largest_acceleration_mm_s2);
  to.set_author_mass_kg(from.author_mass_kg);
  to.set_resets_reliefs(recorded.resets_reliefs);
  return serialize(to);
}

Result<RecordedTiming> decodeTiming(std::span<const std::uint8_t> bytes) {
  Check check;
  proto::Timing from;
  parse(bytes, from, check);
  const auto length = [&](std::int64_t ns) {
    check.require(ns >= 0 && ns <= limits::kLatency_ns, "a latency or a delay is not 0..10 s");
    return Duration(ns);
  };
  const auto side = [&](double mm) {
    return check.number(mm, 1.0, limits::kWorkspace_mm, "a workspace is not 1..1000 mm");
  };
  RecordedTiming to;
  StreamTiming& timing = to.timing;
  timing.number = from.number();
  timing.connected = from.connected();
  timing.first_epoch = from.first_epoch();
  timing.clock_offset = check.time(from.clock_offset_ns());
  timing.pipeline_latency = length(from.pipeline_latency_ns());
  timing.playout_delay_target = length(from.playout_delay_target_ns());
  timing.frame_interval = length(from.frame_interval_ns());
  check.require(from.width_px() >= 1 && from.width_px() <= static_cast<unsigned>(kMaxWidth_px) &&
                    from.height_px() >= 1 &&
                    from.height_px() <= static_cast<unsigned>(kMaxHeight_px),
                "a picture's size is out of range");
  timing.workspace.width_px = static_cast<int>(from.width_px());
  timing.workspace.height_px = static_cast<int>(from.height_px());
  timing.workspace.width_mm = side(from.workspace_width_mm());
  timing.workspace.height_mm = side(from.workspace_height_mm());
  timing.workspace.depth_mm = side(from.workspace_depth_mm());
  timing.workspace.stretch = from.stretch();
  timing.largest_acceleration_mm_s2 =
      check.number(from.largest_acceleration_mm_s2(), 0.0, limits::kAcceleration_mm_s2,
                   "the largest acceleration is out of range");
  timing.author_mass_kg =
      check.number(from.author_mass_kg(), 0.0, limits::kMass_kg, "a mass is out of range");
  to.resets_reliefs = from.resets_reliefs();
  if (check.error()) return Error{check.error()->message};
  return to;
}

RecordedBytes encodeControls(const UserControls& from) {
  proto::UserControls to;
  to.set_number(from.number);
  to.set_paused(from.paused);
  to.set_rearm(from.rearm);
  to.set_rearm_by_itself(from.rearm_by_itself);
  to.set_static_on(from.static_on);
  to.set_dynamic_on(from.dynamic_on);
  to.set_stiffness_factor(from.stiffness_factor);
  to.set_force_factor(from.force_factor);
  to.set_stop(from.stop);
  if (from.friction) to.set_friction(*from.friction);
  if (from.mass_kg) to.set_mass_kg(*from.mass_kg);
  if (from.method) to.set_method(static_cast<std::uint32_t>(*from.method));
  if (from.surface) to.set_surface(static_cast<std::uint32_t>(*from.surface));
  return serialize(to);
}

Result<UserControls> decodeControls(std::span<const std::uint8_t> bytes) {
  Check check;
  proto::UserControls from;
  parse(bytes, from, check);
  UserControls to;
  to.number = from.number();
  to.paused = from.paused();
  to.rearm = from.rearm();
  to.rearm_by_itself = from.rearm_by_itself();
  to.stop = from.stop();
  to.static_on = from.static_on();
  to.dynamic_on = from.dynamic_on();
  to.stiffness_factor =
      check.number(from.stiffness_factor(), 0.1, 3.0, "a stiffness factor is not 0.1..3");
  to.force_factor = check.number(from.force_factor(), 0.0, 1.0, "a force factor is not 0..1");
  if (from.has_friction())
    to.friction = check.number(from.friction(), 0.0, 1.0, "a friction is not 0..1");
  if (from.has_mass_kg())
    to.mass_kg = check.number(from.mass_kg(), 0.0, limits::kMass_kg, "a mass is out of range");
  check.require(from.method() <= 1 && from.surface() <= 2, "an unknown method or surface");
  if (from.has_method()) to.method = static_cast<Method>(from.method());
  if (from.has_surface()) to.surface = static_cast<SurfaceKind>(from.surface());
  if (check.error()) return Error{check.error()->message};
  return to;
}

RecordedBytes encodeSettings(const RendererSettings& from) {
  proto::RendererSettings to;
  to.set_profile(formatDeviceProfile(from.profile));
  to.set_surface(static_cast<std::uint32_t>(from.surface));
  to.set_interpolation(static_cast<std::uint32_t>(from.interpolation));
  to.set_method(static_cast<std::uint32_t>(from.method));
  to.set_unconfirmed(from.unconfirmed);
  to.set_stiffness_n_mm(from.stiffness_N_mm);
  to.set_stiffness_limit_n_mm(from.stiffness_limit_N_mm);
  return serialize(to);
}

Result<RendererSettings> decodeSettings(std::span<const std::uint8_t> bytes) {
  Check check;
  proto::RendererSettings from;
  parse(bytes, from, check);
  check.require(from.surface() <= 2 && from.interpolation() <= 2 && from.method() <= 1,
                "an unknown surface, interpolation or method");
  RendererSettings to;
  const auto stiffness = [&](double N_mm) {
    return check.number(N_mm, 0.0, limits::kStiffness_N_mm, "a stiffness is not 0..1000 N/mm");
  };
  to.stiffness_N_mm = stiffness(from.stiffness_n_mm());
  to.stiffness_limit_N_mm = stiffness(from.stiffness_limit_n_mm());
  if (check.error()) return Error{check.error()->message};
  to.surface = static_cast<SurfaceKind>(from.surface());
  to.interpolation = static_cast<Interpolation>(from.interpolation());
  to.method = static_cast<Method>(from.method());
  to.unconfirmed = from.unconfirmed();
  try {
    std::istringstream profile(from.profile());
    to.profile = readDeviceProfile(profile, "the device profile");
  } catch (const std::runtime_error& error) {
    return Error{error.what()};
  }
  return to;
}

}  // namespace hapticast::client
