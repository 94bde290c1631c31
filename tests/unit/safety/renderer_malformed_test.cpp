// SPDX-License-Identifier: MIT
// Malformed numbers in a stream, one at a time and all at once at random.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>

#include "tests/scenes/false_streams/renderer_attack.hpp"

namespace hapticast::client {
namespace {

/// Sets one number of an object to `value`.
using MalformedField = void (*)(PlayObject&, double);
constexpr MalformedField kMalformedFields[] = {
    [](PlayObject& o, double x) { o.motion.position_mm.x() = x; },
    [](PlayObject& o, double x) { o.motion.position_mm.z() = x; },
    [](PlayObject& o, double x) { o.motion.velocity_mm_s.y() = x; },
    [](PlayObject& o, double x) { o.motion.velocity_mm_s.z() = x; },
    [](PlayObject& o, double x) { o.motion.acceleration_mm_s2.x() = x; },
    [](PlayObject& o, double x) { o.motion.acceleration_mm_s2.z() = x; },
    [](PlayObject& o, double x) { o.motion.angle_rad = x; },
    [](PlayObject& o, double x) { o.motion.angular_velocity_rad_s = x; },
    [](PlayObject& o, double x) { o.motion.quality = x; },
    [](PlayObject& o, double) {
      static const HeightField kEmpty;
      o.field = &kEmpty;
    },
    [](PlayObject& o, double x) {  // a grid of no size, or shorter than it says
      static MotionGrid grid;
      grid.columns = grid.rows = x > 0.0 ? 1'000'000 : -1;
      o.grid = &grid;
    },
    [](PlayObject& o, double x) { o.material.stiffness_N_mm = x; },
    [](PlayObject& o, double x) { o.material.texture_K_mm = x; },
    [](PlayObject& o, double x) {
      o.impact_count = kMaxImpacts;
      for (Impact& impact : o.impacts) impact.delta_velocity_mm_s = {0.0, 0.0, x};
    },
    [](PlayObject& o, double x) {
      o.impact_count = 1'000'000;
      o.impacts[0].time = MediaTime(Duration(x > 0.0 ? std::numeric_limits<std::int64_t>::max()
                                                     : std::numeric_limits<std::int64_t>::min()));
    },
};

TEST(RendererMalformed, RecoversAfterMalformedValuesInEachField) {
  std::size_t number = 0;
  for (const RendererSettings& renderer : listRendererSettings()) {
    for (std::size_t field = 0; field < std::size(kMalformedFields); ++field) {
      for (const double value : {kNaN, kInfinity, -kInfinity, 1e308, -1e308, 1e12, -1e12, 5e3}) {
        if (++number % 7 != 0) continue;  // 120 per setting: over seven settings, each once
        Attack attack(renderer);
        attack.name = "field " + std::to_string(field) + " = " + std::to_string(value);
        bool malformed = false;
        attack.scene = [&](PlayFrame& frame, double) {
          attack.add(frame, plateAt(9.5));
          if (malformed) {
            for (Impact& impact : frame.objects[0].impacts) impact.time = frame.media_time;
            kMalformedFields[field](frame.objects[0], value);
          }
        };
        (void)attack.run(500);
        malformed = true;
        (void)attack.run(60);  // between a good and a bad frame
        (void)attack.run(100);
        malformed = false;
        const TickReport& report = attack.run(700);
        EXPECT_GT(report.force_N.norm(), 0.1) << attack.name;
        if (HasFatalFailure()) return;
      }
    }
  }
}

/// Everything at once, by chance; the largest force it met.
double chaos(const RendererSettings& renderer, unsigned seed, bool moving) {
  std::mt19937_64 random(seed);
  const auto chance = [&](double p) { return std::uniform_real_distribution(0., 1.)(random) < p; };
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(random);
  };
  Attack attack(renderer);
  attack.name = "chaos " + std::to_string(seed);
  attack.scene = [&](PlayFrame& frame, double) {
    const int count = static_cast<int>(between(0.5, 4.0));
    for (int i = 0; i < count; ++i) {
      const double slope = 0.5 * std::floor(between(-3.0, 3.99));
      PlayObject object = plateAt(std::floor(between(6.0, 14.0)),
                                  static_cast<std::uint32_t>(chance(0.9) ? i : 7), slope);
      const double fast = chance(0.1) ? 1e4 : 100.0;
      object.motion.velocity_mm_s = {between(-fast, fast), between(-fast, fast),
                                     between(-fast, fast)};
      object.motion.acceleration_mm_s2 = 30.0 * Vec3::Constant(between(-fast, fast));
      object.motion.angular_velocity_rad_s = chance(0.1) ? between(-100.0, 100.0) : 0.0;
      if (chance(0.3)) object.material.stiffness_N_mm = between(0.0, 8.0);
      if (chance(0.1)) object.impacts[object.impact_count++] = {frame.media_time, {0, 0, fast}};
      if (chance(0.02)) kMalformedFields[random() % std::size(kMalformedFields)](object, kNaN);
      attack.add(frame, object);
    }
  };
  if (moving) attack.hold(Hand::light());
  for (int i = 0; i < 20'000; ++i) {
    if (attack.device && i % 300 == 0) {
      attack.device->setTarget({between(-20.0, 20.0), between(-20.0, 20.0), between(-15.0, 10.0)});
    }
    if (chance(0.002)) attack.streaming = !attack.streaming;
    if (!attack.streaming && chance(0.02)) attack.publish(attack.next_s - between(0.0, 0.3));
    if (chance(0.001)) ++attack.epoch;
    if (chance(0.001)) attack.wishes.paused = !attack.wishes.paused;
    if (chance(0.001)) attack.control.connected = !attack.control.connected;
    if (chance(0.001)) attack.control.first_epoch = attack.epoch = attack.epoch + 1;
    if (chance(0.002)) attack.control.clock_offset = Duration(std::int64_t(between(-1e8, 1e8)));
    if (chance(0.002))
      attack.control.playout_delay_target = Duration(std::int64_t(between(0, 4e8)));
    if (chance(0.001)) attack.control.workspace.width_mm = chance(0.5) ? 160.0 : 100.0;
    if (chance(0.001)) ++attack.wishes.rearm;
    const double luck = between(0.0, 1.0);
    attack.state.status = luck < 0.0002  ? DeviceStatus::kLost
                          : luck < 0.002 ? DeviceStatus::kNoData
                                         : DeviceStatus::kOk;
    (void)attack.step();
    if (::testing::Test::HasFatalFailure()) break;
  }
  return attack.max_force_N;
}

/// Several runs of a renderer; each is checked at every tick, and somewhere in them there is a
/// force.
void liveThrough(const RendererSettings& renderer, unsigned& seed, bool moving) {
  double max_force_N = 0.0;
  for (int i = 0; i < 3; ++i) max_force_N = std::max(max_force_N, chaos(renderer, ++seed, moving));
  EXPECT_GT(max_force_N, 0.1) << "chaos up to " << seed;
}

TEST(RendererMalformed, ChaosDoesNotStepAHandThatStandsStill) {
  unsigned seed = 0;
  for (const RendererSettings& renderer : listRendererSettings())
    liveThrough(renderer, seed, false);
}

TEST(RendererMalformed, ChaosDoesNotStepAHandThatMoves) {
  unsigned seed = 100;
  for (const RendererSettings& renderer : listRendererSettings()) liveThrough(renderer, seed, true);
}

}  // namespace
}  // namespace hapticast::client
