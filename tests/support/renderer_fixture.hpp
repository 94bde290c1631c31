// SPDX-License-Identifier: MIT
// A stage for the renderer under a virtual clock: a stream of a bouncing or still dome, a virtual
// device, a scripted hand. It has no thread of its own.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "client/haptics/renderer.hpp"
#include "common/time.hpp"
#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {

/// A dome of 15 mm radius around the nominal point (10, 5), 5 mm high on a base at `base_mm`.
inline std::shared_ptr<const HeightField> dome(double base_mm, const Workspace& workspace) {
  constexpr int kRadius_px = 60;
  Relief relief;
  const Vec2 centre_px = workspace.toImage({10.0, 5.0});
  relief.rect = {static_cast<int>(centre_px.x()) - kRadius_px,
                 static_cast<int>(centre_px.y()) - kRadius_px, 2 * kRadius_px, 2 * kRadius_px};
  for (int v = 0; v < 2 * kRadius_px; ++v) {
    for (int u = 0; u < 2 * kRadius_px; ++u) {
      const double r = std::hypot(u + 0.5 - kRadius_px, v + 0.5 - kRadius_px) / kRadius_px;
      relief.mask.push_back(r < 1.0 ? 1 : 0);
      relief.height_mm.push_back(static_cast<float>(base_mm + 5.0 * std::max(0.0, 1.0 - r * r)));
    }
  }
  return std::make_shared<const HeightField>(HeightField::prepare(relief, workspace));
}

class RendererFixture {
 public:
  /// `script` is copied; null: the hand is led by device.setTarget().
  explicit RendererFixture(const RendererSettings& renderer_settings, const HandScript* script,
                           double bounce_mm = 0.0, HapticRenderer::Log* log = nullptr)
      : settings(renderer_settings),
        device({settings.profile}, Hand::light(), clock),
        renderer(std::make_unique<HapticRenderer>(settings, pool, stream, user, log)),
        bounce_mm_(bounce_mm) {
    if (script != nullptr) device.lead(*script, "a script");
    state.connected = true;
    state.first_epoch = epoch;
    state.playout_delay_target = Duration(60'000'000);
    stream.store(state);
    for (int i = 0; i < kFps; ++i) {
      fields_.push_back(dome(height_mm(i / static_cast<double>(kFps)), state.workspace));
    }
  }

  /// The receiver's part in this millisecond: a frame every 40 ms.
  void receive() {
    const std::int64_t frame_ns = 1'000'000'000 / kFps;
    while (streaming && next_frame_ * frame_ns <= clock.now().time_since_epoch().count()) {
      publish(next_frame_, MediaTime(Duration(next_frame_ * frame_ns)));
      ++next_frame_;
    }
    if (!streaming) next_frame_ = clock.now().time_since_epoch().count() / frame_ns + 1;
  }
  const TickReport& step() {
    clock.advance(kTickPeriod);
    receive();
    const Vec3 force_N = renderer->report().force_N;
    DeviceState reading = device.exchange(force_N, renderer->report());
    if (!holds) reading.buttons = 0;
    if (silent) reading.status = DeviceStatus::kNoData;
    if (lost) reading.status = DeviceStatus::kLost;
    if (blind) reading.position_mm.setConstant(std::nan(""));
    before_tick();
    const TickReport& report = renderer->tick(clock.now(), reading);
    after_tick();
    max_excess_N = std::max(max_excess_N, report.step_excess_N);
    max_force_N = std::max(max_force_N, report.force_N.norm());
    return report;
  }
  const TickReport& run(int ticks) {
    for (int i = 1; i < ticks; ++i) (void)step();
    return step();
  }
  void newEpoch() {
    ++epoch;
    state.first_epoch = epoch;
    stream.store(state);
  }
  void pause(bool paused) {
    wishes.paused = paused;
    user.store(wishes);
  }
  void rearm() {
    ++wishes.rearm;
    user.store(wishes);
  }

  ManualClock clock;
  RendererSettings settings;
  FramePool pool;
  LatestValue<StreamTiming> stream;
  LatestValue<UserControls> user;
  VirtualDevice device;
  std::unique_ptr<HapticRenderer> renderer;
  StreamTiming state;
  UserControls wishes;
  Material material;
  std::uint32_t epoch = 1;
  bool streaming = true;
  bool lost = false;
  bool silent = false;
  bool blind = false;
  bool holds = true;  // the enabling button, where the device has one
  double max_excess_N = 0.0;
  double max_force_N = 0.0;
  void (*before_tick)() = [] {};
  void (*after_tick)() = [] {};

 private:
  static constexpr int kFps = 25;

  [[nodiscard]] double height_mm(double t_s) const {
    return 12.0 + bounce_mm_ * std::sin(2.0 * M_PI * t_s);
  }
  void publish(std::int64_t number, MediaTime time) {
    FramePool::Index index = 0;
    if (!pool.acquire(index)) return;
    FramePool::Slot& slot = pool.slot(index);
    const double phase_s = static_cast<double>(number % kFps) / kFps;
    slot.fields[0] = fields_[static_cast<std::size_t>(number % kFps)];
    slot.frame = PlayFrame{};
    slot.frame.epoch = epoch;
    slot.frame.id = static_cast<std::uint64_t>(number);
    slot.frame.media_time = time;
    slot.frame.object_count = 1;
    PlayObject& object = slot.frame.objects[0];
    object.id = 7;
    object.field = slot.fields[0].get();
    object.material = material;
    const double w = 2.0 * M_PI;
    object.motion.position_mm = {10.0, 5.0, height_mm(phase_s)};
    object.motion.velocity_mm_s.z() = bounce_mm_ * w * std::cos(w * phase_s);
    object.motion.acceleration_mm_s2.z() = -bounce_mm_ * w * w * std::sin(w * phase_s);
    pool.publish(index);
  }

  double bounce_mm_;
  std::vector<std::shared_ptr<const HeightField>> fields_;
  std::int64_t next_frame_ = 25;  // the clock begins at 1 s
};

}  // namespace hapticast::client
