// SPDX-License-Identifier: MIT
// Cost of a tick of the real-time renderer: HapticRenderer::tick() alone, call by call, under a
// virtual clock, while a frame arrives every 40 ms. Counters in ns: median_ns and p99_ns of all
// ticks (the clock's own time taken off), take_ns: median of the ticks that take over a new frame.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "client/device/loop/realtime_thread.hpp"
#include "tests/support/renderer_fixture.hpp"

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

/// Duration of reading the clock twice.
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
  flushDenormals();  // as the loop's thread does
  RendererSettings settings;
  settings.surface = of.surface;
  HandScript hand(of.hand, HandStiffness{}, {{0.0, {10.0, 5.0, 40.0}}});
  RendererFixture stage(settings, &hand, of.bounce_mm);
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

/// A dome for the stages alone, and the hand on it; the usual one moves and is blended.
struct StageCase {
  SurfaceKind surface = SurfaceKind::kProxy;
  double lift_mm = 3.0;       // 0: every frame is the same
  double friction = 0.0;      // of the material
  double turn_rad_s = 0.0;    // of the object
  bool grid = false;          // its motion has one
  double from_centre_mm = 0;  // where the hand slides; the edge is at 15
  double depth_mm = 1.0;      // of the tip, negative: in the air
};

/// The frames of a case, sent when they are due.
class StageStream {
 public:
  explicit StageStream(const StageCase& of) : of_(of) {
    for (int i = 0; i < (of.lift_mm > 0.0 ? 25 : 1); ++i) {
      fields_.push_back(dome(12.0 + lift_mm(kFrame_s * i), {}));
    }
    grid_.columns = grid_.rows = 8;
    grid_.velocity_mm_s.assign(64, Eigen::Vector3f::Zero());
    grid_.acceleration_mm_s2.assign(64, Eigen::Vector3f::Ones());
  }
  [[nodiscard]] double lift_mm(double t_s) const {
    return of_.lift_mm * std::sin(2.0 * M_PI * t_s);
  }
  void sendUntil(FramePool& pool, std::int64_t ms) {
    for (FramePool::Index index = 0; sent_ * 40 <= ms && pool.acquire(index); ++sent_) {
      PlayFrame& frame = pool.slot(index).frame;
      frame = {};
      frame.epoch = 1;
      frame.id = static_cast<std::uint64_t>(sent_);
      frame.media_time = MediaTime(Duration(sent_ * 40'000'000));
      const double t_s = kFrame_s * static_cast<double>(sent_);
      PlayObject& object = frame.objects[frame.object_count++];
      object.field = fields_[static_cast<std::size_t>(sent_) % fields_.size()].get();
      object.motion.position_mm = {10.0, 5.0, 12.0 + lift_mm(t_s)};
      object.motion.velocity_mm_s.z() = of_.lift_mm * 2.0 * M_PI * std::cos(2.0 * M_PI * t_s);
      object.motion.angle_rad = std::remainder(of_.turn_rad_s * t_s, 2.0 * M_PI);
      object.motion.angular_velocity_rad_s = of_.turn_rad_s;
      object.material.static_friction = object.material.dynamic_friction = of_.friction;
      if (of_.grid) object.grid = &grid_;
      object.grid_rect = {300, 200, 128, 128};
      pool.publish(index);
    }
  }

 private:
  static constexpr double kFrame_s = 0.04;
  StageCase of_;
  std::vector<std::shared_ptr<const HeightField>> fields_;
  MotionGrid grid_;
  std::int64_t sent_ = 0;
};

/// The stages alone, without filters, playout and report: look-up, surface, dynamic force, safety.
void stages(benchmark::State& state, const StageCase& of) {
  const DeviceProfile profile;
  FramePool pool;
  SceneInterpolator lookup(pool, Interpolation::kHermite);
  ProxySurface proxies;
  DynamicForce dynamic(profile);
  SafetyChain safety(profile);
  StreamTiming stream_state;
  stream_state.connected = true;
  stream_state.first_epoch = 1;
  const Workspace workspace;
  StageStream stream(of);
  const double clock_ns = clockCost_ns();
  std::vector<double> all;
  double contacts = 0.0;
  std::int64_t ms = 0;
  for (auto _ : state) {
    stream.sendUntil(pool, ms + 40);
    const double t_s = 1e-3 * static_cast<double>(ms);
    const double x_mm = 4.0 * std::sin(4.0 * t_s);  // up to 2 cm/s
    const double r2 = x_mm * x_mm + of.from_centre_mm * of.from_centre_mm;
    const double top_mm = 12.0 + stream.lift_mm(t_s) + 5.0 * (1.0 - r2 / 225.0);
    const Vec3 hip_mm(10.0 + x_mm, 5.0 + of.from_centre_mm, top_mm - of.depth_mm);
    const auto from = Ticks::now();
    const MediaTime play_time(Duration(ms * 1'000'000));
    const Scene& scene = lookup.at(play_time, stream_state);
    const Contact contact = of.surface == SurfaceKind::kProxy
                                ? proxies.computeContact(scene, hip_mm, workspace, 6.6)
                                : findContact(of.surface, scene, hip_mm, workspace);
    SafetyInput input;
    input.position_mm = hip_mm;
    input.contact = contact.contact;
    input.displacement_mm = contact.displacement_mm;
    input.normal = contact.normal;
    input.surface_velocity_mm_s = contact.surface_velocity_mm_s;
    input.in_contact = input.dynamic_valid = true;
    input.dynamic_N = dynamic.evaluate(contact.object, contact.depth_mm, Vec3::Zero(), play_time,
                                       stream_state, 1.0, &hip_mm);
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
// The usual ones, then what is left out where it is not needed and what it costs where it is.
constexpr auto kNormal = SurfaceKind::kNormal;
BENCHMARK_CAPTURE(stages, proxy, StageCase{})->UseManualTime();
BENCHMARK_CAPTURE(stages, normal, StageCase{.surface = kNormal})->UseManualTime();
BENCHMARK_CAPTURE(stages, perturbed, StageCase{.surface = SurfaceKind::kPerturbed})
    ->UseManualTime();
BENCHMARK_CAPTURE(stages, proxy_same_frames, StageCase{.lift_mm = 0.0})->UseManualTime();
BENCHMARK_CAPTURE(stages, normal_same_frames, StageCase{.surface = kNormal, .lift_mm = 0.0})
    ->UseManualTime();
BENCHMARK_CAPTURE(stages, proxy_friction, StageCase{.friction = 0.3})->UseManualTime();
BENCHMARK_CAPTURE(stages, proxy_turning, StageCase{.turn_rad_s = 1.0})->UseManualTime();
BENCHMARK_CAPTURE(stages, normal_turning, StageCase{.surface = kNormal, .turn_rad_s = 1.0})
    ->UseManualTime();
BENCHMARK_CAPTURE(stages, proxy_motion_grid, StageCase{.grid = true})->UseManualTime();
BENCHMARK_CAPTURE(stages, proxy_near_edge, StageCase{.from_centre_mm = 13.5})->UseManualTime();
BENCHMARK_CAPTURE(stages, proxy_in_the_air, StageCase{.depth_mm = -3.0})->UseManualTime();
BENCHMARK_CAPTURE(stages, proxy_above_all, StageCase{.depth_mm = -20.0})->UseManualTime();

}  // namespace
}  // namespace hapticast::client
