// SPDX-License-Identifier: MIT
// The scene of the renderer's extreme cases: a renderer, a stream and a hand under a virtual clock.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <tuple>

#include "client/haptics/renderer.hpp"
#include "tests/evaluate/stability/stability_cases.hpp"
#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/support/frame_builder.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::evaluate {

inline constexpr PixelRect kRendererPlate_px{288, 208, 64, 64};  // +-8 mm about the middle
inline constexpr double kRoomPixel_mm = 0.25;

/// Made once, kept for both runs of a case.
class RendererReliefs {
 public:
  const HeightField* at(int shift_px, double height_mm, bool dome) {
    const auto key = std::make_tuple(shift_px, height_mm, dome);
    std::shared_ptr<const HeightField>& field = reliefs_[key];
    if (field) return field.get();
    PixelRect rect = kRendererPlate_px;
    rect.u += shift_px;
    const Vec2 centre(shift_px * kRoomPixel_mm, 0.0);
    field = client::makeField(
        rect, Workspace{},
        [=](const Vec2& at) {
          return height_mm - (dome ? 0.02 * (at - centre).squaredNorm() : 0.0);
        },
        [](const Vec2&) { return true; });
    return field.get();
  }

 private:
  std::map<std::tuple<int, double, bool>, std::shared_ptr<const HeightField>> reliefs_;
};

/// A renderer, a stream, a light hand; time t_s counts from the beginning, the event is at 0.
class RendererScene {
 public:
  static constexpr double kEvent_s = 2.5;
  static constexpr double kEnd_s = 5.0;
  static constexpr double kFriction_N = 0.05;  // as in the profile of an Omni
  static constexpr double kBegin_s = 1.0;      // of the stream

  RendererScene(bool naive, RendererReliefs& all) : reliefs(all), naive_(naive), settings_() {
    renderer =
        std::make_unique<client::HapticRenderer>(settings_, pool, stream_door, user_door, nullptr);
    device = std::make_unique<client::VirtualDevice>(
        client::PlantProfile{settings_.profile, kFriction_N}, client::Hand::light(), clock);
    stream.connected = true;
    stream.first_epoch = epoch;
    stream.playout_delay_target = Duration(60'000'000);
  }

  CaseOutcome run() {
    const DeviceMapping mapping = DeviceMapping::fit(Workspace{}, settings_.profile.workspace_mm);
    device->reset(mapping.toDevice(handAt(-kEvent_s)), Vec3::Zero());
    next_frame_s_ = kBegin_s;
    CaseOutcome out;
    double begin_mJ = 0.0;
    for (int tick = 0; tick < static_cast<int>((kEvent_s + kEnd_s) * 1e3); ++tick) {
      t_s = tick * 1e-3 - kEvent_s;
      if (at_tick) at_tick(*this);
      clock.advance(Duration(1'000'000));
      sendDue();
      stream_door.store(stream);
      user_door.store(user);
      device->setTarget(mapping.toDevice(handAt(t_s)));
      step();
      if (tick == static_cast<int>(kEvent_s * 1e3) - 1) begin_mJ = work_mJ_;
      if (t_s < 0.0) continue;
      see(out, begin_mJ);
    }
    out.end_N = force_N_.norm();
    return out;
  }
  void add(client::PlayFrame& frame, const client::PlayObject& object) {
    frame.objects[frame.object_count++] = object;
  }
  void send(double media_s) {
    client::PlayFrame frame;
    frame.epoch = epoch;
    frame.id = ++id;
    frame.media_time = mediaTime(media_s);
    scene(frame, media_s - kBegin_s - kEvent_s);
    (void)client::send(pool, frame);
  }

  RendererReliefs& reliefs;
  client::FramePool pool;
  LatestValue<client::StreamTiming> stream_door;
  LatestValue<client::UserControls> user_door;
  std::unique_ptr<client::HapticRenderer> renderer;
  std::unique_ptr<client::VirtualDevice> device;
  ManualClock clock;
  client::StreamTiming stream;
  client::UserControls user;
  std::uint32_t epoch = 1;
  std::uint64_t id = 0;
  double fps = 25.0;
  bool streaming = true;
  double naive_stiffness_N_mm = 0.0;  ///< of the material; 0: the device's own
  double t_s = 0.0;
  std::function<Vec3(double)> target_mm = [](double) { return Vec3(0.1, 0.1, 5.0); };  // nominal
  std::function<void(client::PlayFrame&, double)> scene;  // at a time of the media
  std::function<void(RendererScene&)> at_tick;

 private:
  /// From 20 mm above down to the target before the event.
  [[nodiscard]] Vec3 handAt(double t) const {
    const double s = std::clamp((t + 1.6) / 0.6, 0.0, 1.0);
    return target_mm(t) + Vec3(0.0, 0.0, (1.0 - s) * 20.0);
  }
  void sendDue() {
    const double now_s = toSeconds(clock.now().time_since_epoch());
    while (next_frame_s_ <= now_s) {
      if (streaming) send(next_frame_s_);
      next_frame_s_ += 1.0 / fps;
    }
  }
  void step() {
    const Vec3 before_mm = device->truePosition_mm();
    const client::DeviceState state = device->exchange(force_N_, renderer->report());
    work_mJ_ += sent_N_[1].dot(device->truePosition_mm() - before_mm);  // the profile's delay is 1
    sent_N_[1] = sent_N_[0];
    const client::TickReport& report = renderer->tick(clock.now(), state);
    last_N_ = force_N_;
    force_N_ = naive_ ? naiveForce(report) : report.force_N;
    sent_N_[0] = force_N_;
  }
  /// K d along the surface's push and the dynamic force, clamped: what is found is rendered.
  Vec3 naiveForce(const client::TickReport& report) {
    const double static_N = report.static_force_N.norm();
    if (static_N > 0.0) direction_ = report.static_force_N / static_N;
    const double k_N_mm =
        naive_stiffness_N_mm != 0.0 ? naive_stiffness_N_mm : settings_.profile.stiffness_N_mm;
    const double spring_N = std::max(0.0, k_N_mm) * report.penetration_mm * report.mapping.scale;
    Vec3 force_N = std::min(spring_N, 1e3) * direction_ + report.dynamic_force_N;
    if (!report.contact) force_N.setZero();
    const double size_N = force_N.norm();
    return size_N > settings_.profile.peak_N ? Vec3(force_N * (settings_.profile.peak_N / size_N))
                                             : force_N;
  }
  void see(CaseOutcome& out, double begin_mJ) {
    const client::TickReport& report = renderer->report();
    out.peak_N = std::max(out.peak_N, force_N_.norm());
    out.step_N = std::max(out.step_N, (force_N_ - last_N_).norm());
    out.excess_N = std::max(out.excess_N, report.step_excess_N);
    out.speed_mm_s = std::max(out.speed_mm_s, device->trueVelocity_mm_s().z());
    out.energy_mJ = std::max(out.energy_mJ, work_mJ_ - begin_mJ);
    out.finite = out.finite && force_N_.allFinite();
    out.safety_actions |= report.safety_actions;
    out.trace_N.push_back(force_N_.norm());
    out.trace_mm_s.push_back(device->trueVelocity_mm_s().z());
  }

  bool naive_;
  client::RendererSettings settings_;
  double next_frame_s_ = 0.0;
  Vec3 force_N_ = Vec3::Zero();
  Vec3 last_N_ = Vec3::Zero();
  Vec3 direction_ = Vec3::UnitZ();
  Vec3 sent_N_[2] = {Vec3::Zero(), Vec3::Zero()};
  double work_mJ_ = 0.0;
};

}  // namespace hapticast::evaluate
