// SPDX-License-Identifier: MIT
// A hand that presses on a still plate while the stream or the machine has discontinuities, round
// the renderer under a virtual clock. The plant is not that of the virtual device: one rigid mass
// on each axis, semi-implicit Euler at 20 kHz, Coulomb friction. So it checks by other means.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "client/haptics/renderer.hpp"
#include "tests/support/frame_builder.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::client {

/// Device and hand of a bench: what the profile says, and what is true.
struct PressSetup {
  DeviceProfile profile;
  double stiffness_N_mm = 0.5;
  double device_kg = 0.045;  ///< true mass of the device
  int delay_ticks = 1;       ///< true delay
  double hand_kg = 0.15;
  double hand_N_mm = 0.2;
  double hand_Ns_m = 5.0;
  double friction_N = 0.05;
  double depth_mm = 6.0;  ///< the target of the hand below the plate's surface
  double frames_per_s = 25.0;
};

class PressBench {
 public:
  static constexpr double kPlate_mm = 10.0;
  static constexpr double kRest_s = 0.5;

  explicit PressBench(const PressSetup& setup) : setup_(setup) {
    settings_.profile = setup.profile;
    settings_.profile.stiffness_N_mm = setup.stiffness_N_mm;
    renderer = std::make_unique<HapticRenderer>(settings_, *pool_, timing_, user_, nullptr);
    mapping_ = DeviceMapping::fit(Workspace{}, settings_.profile.workspace_mm);
    stream.connected = true;
    stream.first_epoch = epoch;
    stream.playout_delay_target = Duration(60'000'000);
    stream.frame_interval = fromSeconds(1.0 / setup.frames_per_s);
    target_mm = mapping_.toDevice({0.1, 0.1, kPlate_mm - setup.depth_mm / mapping_.scale});
    // The hand rests 5 mm above the plate until the force has faded in.
    at_mm_ = mapping_.toDevice({0.1, 0.1, kPlate_mm + 5.0});
    rest_mm_ = at_mm_;
    next_s_ = toSeconds(clock_.now().time_since_epoch());
    begin_s_ = next_s_;
    scene = [this](PlayFrame& frame, double) { add(frame, 1); };
  }

  /// Adds the plate to a frame.
  PlayObject& add(PlayFrame& frame, std::uint32_t id, double height_mm = kPlate_mm) {
    auto& field = fields_[height_mm];
    if (!field) {
      field = makeField(
          {240, 160, 160, 160}, Workspace{}, [=](const Vec2&) { return height_mm; },
          [](const Vec2&) { return true; });
    }
    PlayObject& object = frame.objects[frame.object_count++];
    object = makeObject(id, field.get(), {0.0, 0.0, height_mm});
    return object;
  }

  /// One tick, `late_ms` after the last one. Returns its report.
  const TickReport& step(int late_ms = 1) {
    for (int ms = 0; ms < late_ms; ++ms) {
      simulate(actingForce(ms));
      clock_.advance(kTickPeriod);
    }
    time_s = toSeconds(clock_.now().time_since_epoch()) - begin_s_;
    publish();
    timing_.store(stream);
    user_.store(user);
    const double count_mm = settings_.profile.count_mm;
    DeviceState state{.position_mm = (at_mm_ / count_mm).array().round() * count_mm,
                      .time = clock_.now()};
    const TickReport& report = renderer->tick(clock_.now(), state);
    const double force_N = report.force_N.norm();
    peak_N = std::max(peak_N, force_N);
    finite = finite && report.force_N.allFinite();
    if (report.contact) {
      ++contact_ticks;
      if (force_N < 0.05) ++silent_ticks;
    }
    send_ms_ += late_ms;
    history_.push_back({send_ms_, report.force_N});
    return report;
  }
  /// Most work on the hand in any `seconds` from `from_s` on.
  [[nodiscard]] double mostWork_mJ(double from_s, double seconds) const {
    const auto window = static_cast<std::size_t>(seconds * 1000.0);
    const auto first = static_cast<std::size_t>(from_s * 1000.0);
    double most_mJ = 0.0;
    for (std::size_t end = first; end < work_mJ.size(); end += 5) {
      const std::size_t begin = std::max(first, end > window ? end - window : 0);
      for (std::size_t at = begin; at < end; at += 5)
        most_mJ = std::max(most_mJ, work_mJ[end] - work_mJ[at]);
    }
    return most_mJ;
  }

  std::unique_ptr<HapticRenderer> renderer;
  StreamTiming stream;
  UserControls user;
  std::function<void(PlayFrame&, double)> scene;  ///< fills a frame of a time since the begin, s
  std::uint32_t epoch = 1;
  bool streaming = true;
  Vec3 target_mm = Vec3::Zero();  ///< device frame
  double time_s = 0.0;
  std::vector<double> work_mJ;  ///< true work on the hand, up to each millisecond
  double peak_N = 0.0;
  bool finite = true;
  std::size_t contact_ticks = 0;
  std::size_t silent_ticks = 0;  ///< in contact without a force

 private:
  struct Sent {
    std::int64_t ms;
    Vec3 force_N;
  };
  /// The newest force that was sent at least the delay ago, `ms` after the last tick.
  [[nodiscard]] Vec3 actingForce(int ms) const {
    for (auto sent = history_.rbegin(); sent != history_.rend(); ++sent) {
      if (sent->ms + setup_.delay_ticks <= send_ms_ + ms) return sent->force_N;
    }
    return Vec3::Zero();
  }
  void simulate(const Vec3& force_N) {
    constexpr int kSteps = 20;
    constexpr double kStep_s = 1e-3 / kSteps;
    const double mass_kg = setup_.device_kg + setup_.hand_kg;
    double done_mJ = work_mJ.empty() ? 0.0 : work_mJ.back();
    for (int i = 0; i < kSteps; ++i) {
      const Vec3& goal_mm = time_s < kRest_s ? rest_mm_ : target_mm;
      const Vec3 push_N =
          force_N + setup_.hand_N_mm * (goal_mm - at_mm_) - 1e-3 * setup_.hand_Ns_m * speed_mm_s_;
      for (int axis = 0; axis < 3; ++axis) {
        const double free_mm_s = speed_mm_s_[axis] + 1e3 * push_N[axis] / mass_kg * kStep_s;
        const double most_mm_s = 1e3 * setup_.friction_N / mass_kg * kStep_s;
        speed_mm_s_[axis] = free_mm_s - std::clamp(free_mm_s, -most_mm_s, most_mm_s);
      }
      at_mm_ += kStep_s * speed_mm_s_;
      done_mJ += kStep_s * force_N.dot(speed_mm_s_);
    }
    work_mJ.push_back(done_mJ);
  }
  void publish() {
    while (next_s_ - begin_s_ <= time_s) {
      if (streaming) {
        PlayFrame frame;
        frame.epoch = epoch;
        frame.id = ++id_;
        frame.media_time = mediaTime(next_s_);
        scene(frame, next_s_ - begin_s_);
        (void)send(*pool_, frame);
      }
      next_s_ += 1.0 / setup_.frames_per_s;
    }
  }

  PressSetup setup_;
  RendererSettings settings_;
  std::unique_ptr<FramePool> pool_ = std::make_unique<FramePool>();
  LatestValue<StreamTiming> timing_;
  LatestValue<UserControls> user_;
  DeviceMapping mapping_;
  ManualClock clock_;
  std::map<double, std::shared_ptr<const HeightField>> fields_;
  std::uint64_t id_ = 0;
  double next_s_ = 0.0;
  double begin_s_ = 0.0;
  Vec3 rest_mm_ = Vec3::Zero();
  Vec3 at_mm_ = Vec3::Zero();
  Vec3 speed_mm_s_ = Vec3::Zero();
  std::int64_t send_ms_ = 0;
  std::vector<Sent> history_;
};

}  // namespace hapticast::client
