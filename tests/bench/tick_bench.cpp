// SPDX-License-Identifier: MIT
// What a tick of the real-time room costs: Room::tick alone, call by call, under a virtual clock,
// while a frame arrives every 40 ms. Counters in ns: median_ns and p99_ns of all ticks (the clock's
// own time taken off), take_ns: median of the ticks that take over a new frame.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "tests/unit/client/stage.hpp"

namespace hapticast::client {
namespace {

using Ticks = std::chrono::steady_clock;
Ticks::time_point begin;
Ticks::duration took;

double quantile(std::vector<double>& values, double q) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double ns(Ticks::duration duration) {
  return std::chrono::duration<double, std::nano>(duration).count();
}

/// What reading the clock twice takes.
double clockCost_ns() {
  std::vector<double> costs;
  for (int i = 0; i < 10000; ++i) {
    const auto from = Ticks::now();
    costs.push_back(ns(Ticks::now() - from));
  }
  return quantile(costs, 0.5);
}

struct Case {
  SurfaceKind surface = SurfaceKind::kProxy;
  HandKind hand = HandKind::kSlide;
  double bounce_mm = 3.0;
  double friction = 0.0;
  bool objects = true;
};

void tick(benchmark::State& state, const Case& of) {
  RoomSettings settings;
  settings.surface = of.surface;
  HandScript hand(of.hand, HandStiffness{}, {{0.0, {10.0, 5.0, 40.0}}});
  Stage stage(settings, &hand, of.bounce_mm);
  stage.material.static_friction = stage.material.dynamic_friction = of.friction;
  stage.streaming = of.objects;
  (void)stage.run(of.objects ? 3000 : 100);
  stage.before_tick = [] { begin = Ticks::now(); };
  stage.after_tick = [] { took = Ticks::now() - begin; };
  const double clock_ns = clockCost_ns();
  std::vector<double> all;
  std::vector<double> taking;
  double contact = 0.0;
  for (auto _ : state) {
    contact += stage.step().contact;
    state.SetIterationTime(1e-9 * std::max(1.0, ns(took) - clock_ns));
    all.push_back(ns(took) - clock_ns);
    if (stage.clock.now().time_since_epoch().count() % 40'000'000 == 0) {
      taking.push_back(all.back());
    }
  }
  state.counters["median_ns"] = quantile(all, 0.5);
  state.counters["p99_ns"] = quantile(all, 0.99);
  if (!taking.empty()) state.counters["take_ns"] = quantile(taking, 0.5);
  state.counters["contact"] = contact / static_cast<double>(all.size());
}
BENCHMARK_CAPTURE(tick, proxy_slide, Case{})->UseManualTime();
BENCHMARK_CAPTURE(tick, proxy_slide_still, Case{.bounce_mm = 0.0})->UseManualTime();
BENCHMARK_CAPTURE(tick, proxy_slide_friction, Case{.friction = 0.3})->UseManualTime();
BENCHMARK_CAPTURE(tick, proxy_press, Case{.hand = HandKind::kPress})->UseManualTime();
BENCHMARK_CAPTURE(tick, proxy_free, Case{.hand = HandKind::kFile})->UseManualTime();
BENCHMARK_CAPTURE(tick, proxy_no_object, Case{.objects = false})->UseManualTime();
BENCHMARK_CAPTURE(tick, normal_slide, Case{.surface = SurfaceKind::kNormal})->UseManualTime();
BENCHMARK_CAPTURE(tick, normal_free, Case{.surface = SurfaceKind::kNormal, .hand = HandKind::kFile})
    ->UseManualTime();
BENCHMARK_CAPTURE(tick, perturbed_slide, Case{.surface = SurfaceKind::kPerturbed})->UseManualTime();

/// The stages alone, without filters, playout and report: look-up, surface, dynamic force, safety.
void stages(benchmark::State& state, SurfaceKind surface) {
  constexpr double kFrame_s = 0.04;
  const DeviceProfile profile;
  FramePool pool;
  FrameLookup lookup(pool, Interpolation::kHermite);
  ProxySurface proxies;
  DynamicForce dynamic(profile);
  SafetyChain safety(profile);
  Controls controls;
  controls.connected = true;
  controls.first_epoch = 1;
  const Workspace workspace;
  const auto lift_mm = [](double t_s) { return 3.0 * std::sin(2.0 * M_PI * t_s); };
  std::vector<std::shared_ptr<const HeightField>> fields;
  for (int i = 0; i < 25; ++i) fields.push_back(dome(12.0 + lift_mm(kFrame_s * i), workspace));
  std::uint64_t sent = 0;
  const auto send = [&] {
    FramePool::Index index = 0;
    if (!pool.acquire(index)) return;
    PlayFrame frame;
    frame.epoch = 1;
    frame.id = sent;
    frame.media_time = MediaTime(Duration(static_cast<std::int64_t>(sent) * 40'000'000));
    const double t_s = kFrame_s * static_cast<double>(sent);
    PlayObject& object = frame.objects[frame.object_count++];
    object.field = fields[sent % 25].get();
    object.motion.position_mm = {10.0, 5.0, 12.0 + lift_mm(t_s)};
    object.motion.velocity_mm_s.z() = 6.0 * M_PI * std::cos(2.0 * M_PI * t_s);
    pool.slot(index).frame = frame;
    pool.publish(index);
    ++sent;
  };
  const double clock_ns = clockCost_ns();
  std::vector<double> all;
  double contacts = 0.0;
  std::int64_t ms = 0;
  for (auto _ : state) {
    while (static_cast<std::int64_t>(sent) * 40 <= ms + 40) send();
    const double t_s = 1e-3 * static_cast<double>(ms);
    const double x_mm = 4.0 * std::sin(4.0 * t_s);  // 1 mm deep, up to 2 cm/s
    const Vec3 hip_mm(10.0 + x_mm, 5.0,
                      12.0 + lift_mm(t_s) + 5.0 * (1.0 - x_mm * x_mm / 225.0) - 1.0);
    const auto from = Ticks::now();
    const MediaTime play_time(Duration(ms * 1'000'000));
    const Scene& scene = lookup.at(play_time, controls);
    const Contact contact = surface == SurfaceKind::kProxy
                                ? proxies.touch(scene, hip_mm, workspace, 6.6)
                                : findContact(surface, scene, hip_mm, workspace);
    SafetyInput input;
    input.position_mm = hip_mm;
    input.contact = contact.contact;
    input.displacement_mm = contact.displacement_mm;
    input.normal = contact.normal;
    input.surface_velocity_mm_s = contact.surface_velocity_mm_s;
    input.touchable = input.dynamic_valid = true;
    input.dynamic_N = dynamic.evaluate(contact.object, contact.depth_mm, Vec3::Zero(), play_time,
                                       controls, 1.0, &hip_mm);
    benchmark::DoNotOptimize(safety.step(input));
    all.push_back(ns(Ticks::now() - from) - clock_ns);
    state.SetIterationTime(1e-9 * std::max(1.0, all.back()));
    contacts += contact.contact;
    ++ms;
  }
  state.counters["median_ns"] = quantile(all, 0.5);
  state.counters["p99_ns"] = quantile(all, 0.99);
  state.counters["contact"] = contacts / static_cast<double>(all.size());
}
BENCHMARK_CAPTURE(stages, proxy, SurfaceKind::kProxy)->UseManualTime();
BENCHMARK_CAPTURE(stages, normal, SurfaceKind::kNormal)->UseManualTime();
BENCHMARK_CAPTURE(stages, perturbed, SurfaceKind::kPerturbed)->UseManualTime();

}  // namespace
}  // namespace hapticast::client
