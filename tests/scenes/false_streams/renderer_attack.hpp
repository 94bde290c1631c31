// SPDX-License-Identifier: MIT
// A stream that attacks the renderer: real frames through the pool under a virtual clock. The tip
// is held still, so the hand explains no step: the force may change by S per tick and no more. That
// bound does not use the chain's own meter.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/device/profile/device_profile.hpp"
#include "client/haptics/renderer.hpp"
#include "tests/support/chain_fixture.hpp"
#include "tests/support/frame_builder.hpp"

namespace hapticast::client {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr PixelRect kPlate_px{240, 160, 160,
                                     160};  // +-20 mm about the middle of the picture

/// A plate whose middle is `height_mm` high.
inline PlayObject plateAt(double height_mm, std::uint32_t id = 1, double slope = 0.0) {
  static std::map<std::pair<double, double>, std::shared_ptr<const HeightField>> fields;
  auto& field = fields[{height_mm, slope}];
  if (!field) {
    field = makeField(
        kPlate_px, Workspace{}, [=](const Vec2& at) { return height_mm + slope * at.x(); },
        [](const Vec2&) { return true; });
  }
  return makeObject(id, field.get(), {0.0, 0.0, height_mm});
}

/// The renderer, a stream and a tip that stands still in the device frame.
class Attack {
 public:
  explicit Attack(const RendererSettings& renderer_settings, double tip_height_mm = 8.0)
      : settings(renderer_settings),
        renderer(std::make_unique<HapticRenderer>(settings, pool, stream, user, nullptr)) {
    const DeviceMapping mapping = DeviceMapping::fit(Workspace{}, settings.profile.workspace_mm);
    state.position_mm = mapping.toDevice({0.1, 0.1, tip_height_mm});
    control.connected = true;
    control.first_epoch = epoch;
    control.playout_delay_target = Duration(60'000'000);
    next_s = toSeconds(clock.now().time_since_epoch());
  }

  /// One tick; the stream goes on with `scene` at 25 frames/s while `streaming`.
  const TickReport& step() {
    clock.advance(Duration(1'000'000));
    const double now_s = toSeconds(clock.now().time_since_epoch());
    while (next_s <= now_s) {
      if (streaming) publish(next_s);
      next_s += 0.04;
    }
    stream.store(control);
    user.store(wishes);
    if (device)
      state.position_mm =
          device->exchange(renderer->report().force_N, renderer->report()).position_mm;
    state.time = clock.now();
    const Vec3 before_N = renderer->report().force_N;
    const TickReport& report = renderer->tick(clock.now(), state);
    check(report, before_N);
    return report;
  }
  const TickReport& run(int ticks) {
    for (int i = 1; i < ticks; ++i) (void)step();
    return step();
  }
  /// From now on a hand holds a virtual device instead of standing still.
  void hold(const Hand& hand) {
    PlantProfile plant = loadDeviceProfile(settings.profile.name);  // for its losses
    static_cast<DeviceProfile&>(plant) = settings.profile;
    device.emplace(plant, hand, clock);
  }
  void publish(double media_s) {
    PlayFrame frame;
    frame.epoch = epoch;
    frame.id = ++id;
    frame.media_time = mediaTime(media_s);
    scene(frame, media_s);
    (void)send(pool, frame);
  }
  /// From now on the stream shows a plate whose middle is this high.
  void showPlate(double height_mm) {
    scene = [this, height_mm](PlayFrame& frame, double) { add(frame, plateAt(height_mm)); };
  }
  void add(PlayFrame& frame, const PlayObject& object) {
    frame.objects[frame.object_count++] = object;
  }

  ManualClock clock;
  RendererSettings settings;
  FramePool pool;
  LatestValue<StreamTiming> stream;
  LatestValue<UserControls> user;
  std::unique_ptr<HapticRenderer> renderer;
  StreamTiming control;
  UserControls wishes;
  DeviceState state;
  std::optional<VirtualDevice> device;
  std::function<void(PlayFrame&, double)> scene = [](PlayFrame&, double) {};
  std::uint32_t epoch = 1;
  std::uint64_t id = 0;
  bool streaming = true;
  double next_s = 0.0;
  double max_force_N = 0.0;
  double max_step_N = 0.0;
  std::string name;

 private:
  void check(const TickReport& report, const Vec3& before_N) {
    const DeviceProfile& profile = settings.profile;
    const double force_N = report.force_N.norm();
    const double step_N = (report.force_N - before_N).norm();
    const double allowed_N =
        force_N > before_N.norm() ? profile.slew_rise_N_per_tick : profile.slew_fall_N_per_tick;
    ASSERT_TRUE(report.force_N.allFinite()) << name;
    ASSERT_LE(force_N, profile.peak_N + 1e-9) << name;
    if (!device) {
      ASSERT_LE(step_N, allowed_N + 1e-9) << name << ", tick " << report.tick;
    }
    ASSERT_EQ(report.step_excess_N, 0.0) << name << ", tick " << report.tick;
    max_force_N = std::max(max_force_N, force_N);
    max_step_N = std::max(max_step_N, step_N);
  }
};

/// Devices, surfaces, interpolations, methods, delays of 0-5 ticks.
inline std::vector<RendererSettings> listRendererSettings() {
  std::vector<RendererSettings> all_settings;
  for (const char* profile : {"omni", "falcon"}) {
    for (const SurfaceKind surface :
         {SurfaceKind::kProxy, SurfaceKind::kNormal, SurfaceKind::kPerturbed}) {
      for (const Interpolation interpolation :
           {Interpolation::kHermite, Interpolation::kLinear, Interpolation::kHold}) {
        for (const Method method : {Method::kHapticast, Method::kThesis}) {
          if (method == Method::kThesis && interpolation != Interpolation::kHermite) continue;
          RendererSettings renderer;
          renderer.profile = loadDeviceProfile(profile);
          renderer.profile.delay_ticks = static_cast<int>(all_settings.size() % 6);
          renderer.surface = surface;
          renderer.interpolation = interpolation;
          renderer.method = method;
          all_settings.push_back(renderer);
        }
      }
    }
  }
  return all_settings;
}

}  // namespace hapticast::client
