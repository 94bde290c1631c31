// SPDX-License-Identifier: MIT
// The wall under hands that move: the error of the force and what of it lies above 50 Hz, the first
// touch, and devices that answer later than assumed.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/support/vibration.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

struct Moving {
  const NamedHand* hand;
  int way, delay;
  double stiffness_N_mm, friction_N;
  double error_N = 0.0, above_50Hz_N = 0.0;
  int alarms = 0;  // of the oscillation detector
};
constexpr int kWays = 5;

/// A slow press, 2 Hz and 5 Hz in the wall, taps, tremor: where the hand wants to be, in stretches
/// of 1 N.
double wayOf(int way, double t, double stretch_mm) {
  const double w = 2.0 * M_PI * t;
  switch (way) {
    case 0:
      return 3.0 - (3.0 + 2.0 * stretch_mm) * (0.5 - 0.5 * std::cos(0.25 * w));
    case 1:
      return -stretch_mm * (1.0 + 0.8 * std::sin(2.0 * w));
    case 2:
      return -stretch_mm * (1.0 + 0.6 * std::sin(5.0 * w));
    case 3:
      return 3.0 - (3.0 + 1.5 * stretch_mm) * std::max(0.0, std::sin(3.0 * w));
    default:
      return -stretch_mm + 0.3 * std::sin(9.0 * w);
  }
}

/// The force against K times the true depth, and what of the difference lies above 50 Hz.
void runCase(Moving& c) {
  const PlantProfile profile = sweepProfile(c.stiffness_N_mm, c.delay, c.friction_N);
  ChainFixture rig(profile, profile, c.hand->hand);
  const double stretch_mm = 1e3 / c.hand->hand.stiffness_N_m + 1.0 / c.stiffness_N_mm;
  rig.device.reset({0.0, 0.0, 3.0}, Vec3::Zero());
  Above50Hz filter;
  constexpr int kTicks = 4000;
  constexpr int kFrom = 1000;
  for (int i = 0; i < kTicks; ++i) {
    const double wanted_mm = wayOf(c.way, i * 1e-3, stretch_mm);
    rig.device.setTarget({0.0, 0.0, 3.0 + (wanted_mm - 3.0) * std::min(1.0, i / 300.0)});
    c.alarms += rig.step().latency_alarm ? 1 : 0;
    const double depth_mm = std::max(0.0, rig.wall_mm - rig.device.truePosition_mm().z());
    const double off_N = rig.out.force_N.z() - c.stiffness_N_mm * depth_mm;
    const double fast_N = filter.next(off_N);
    if (i < kFrom) continue;
    c.error_N += off_N * off_N / (kTicks - kFrom);
    c.above_50Hz_N += fast_N * fast_N / (kTicks - kFrom);
  }
  c.error_N = std::sqrt(c.error_N);
  c.above_50Hz_N = std::sqrt(c.above_50Hz_N);
}

void inMotion(const StabilityReport& to) {
  std::size_t runs = 0, alarmed = 0;
  for (const double asked_N_mm : {0.5, 2.0, 10.0}) {
    std::vector<Moving> cells;
    for (const int d : {0, 1, 2, 3, 5}) {
      const double k = std::min(asked_N_mm, stiffnessLimit_N_mm(omni(1.0, d)));
      for (int hand = 0; hand < 4; ++hand) {
        for (int way = 0; way < kWays; ++way) {
          for (const double friction_N : {0.0, 0.05}) {
            cells.push_back({&kHands[static_cast<std::size_t>(hand)], way, d, k, friction_N});
          }
        }
      }
    }
    onAllCores(cells.size(), [&](std::size_t i) { runCase(cells[i]); });
    double error_N = 0.0;
    double fast_N = 0.0;
    for (const Moving& c : cells) {
      error_N += c.error_N / double(cells.size());
      fast_N += c.above_50Hz_N / double(cells.size());
      alarmed += c.alarms > 0 ? 1 : 0;
    }
    runs += cells.size();
    const std::string name = asked_N_mm > 5.0 ? "K_max" : text("K %g", asked_N_mm);
    to.report.add({"in motion", "moving_error", name, error_N, "N rms", 0.0, true});
    to.report.add({"in motion", "moving_above_50Hz", name, fast_N, "N rms", 0.0, true});
  }
  to.report.require(text("false alarms of the latency watch in %zu moving runs", runs), "0",
                    text("%zu", alarmed), alarmed == 0);
}

/// How far the tip goes to and fro in the last three seconds of a push into the wall, and when the
/// oscillation detector first raised its alarm (< 0: never).
struct Swing {
  double way_mm = 0.0;
  int alarm_tick = -1;
};

Swing swingOf(const PlantProfile& assumed, const PlantProfile& real, const Hand& hand,
              double push_N, double speed_mm_s, bool detects) {
  ChainFixture rig(assumed, real, hand, {.oscillation_detector = detects});
  const bool free = hand.stiffness_N_m == 0.0;
  const double stretch_mm =
      push_N * ((free ? 0.0 : 1e3 / hand.stiffness_N_m) + 1.0 / rig.renderedStiffness_N_mm());
  rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
  rig.run(250);
  if (free) rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -speed_mm_s});
  const int approach = static_cast<int>(20e3 / speed_mm_s);
  Swing swing;
  double low_mm = 1e9, high_mm = -1e9;
  for (int i = 0; i < approach + 4000; ++i) {
    rig.device.setPush({0.0, 0.0, free ? -push_N * std::min(1.0, i / 200.0) : 0.0});
    rig.device.setTarget({0.0, 0.0, std::max(-stretch_mm, 20.0 - 1e-3 * speed_mm_s * i)});
    if (rig.step().latency_alarm && swing.alarm_tick < 0) swing.alarm_tick = i;
    if (i < approach + 1000) continue;
    low_mm = std::min(low_mm, rig.device.truePosition_mm().z());
    high_mm = std::max(high_mm, rig.device.truePosition_mm().z());
  }
  swing.way_mm = high_mm - low_mm;
  return swing;
}

/// Devices that answer two ticks later than assumed, pushed at random: those that swing without the
/// detector have to be found by it.
void slowDevices(const StabilityReport& to) {
  struct Cell {
    Swing alone, detects;
  };
  std::vector<Cell> cells(300);
  onAllCores(cells.size(), [&](std::size_t i) {
    std::mt19937 random(static_cast<unsigned>(i));
    const auto between = [&](double a, double b) {
      return std::uniform_real_distribution(a, b)(random);
    };
    std::vector<NamedHand> hands = quietHands();
    hands.insert(hands.end(), heavyArms().begin(), heavyArms().end());
    const Hand hand = hands[random() % hands.size()].hand;
    const int d = static_cast<int>(random() % 4);
    const double k = std::min(stiffnessLimit_N_mm(omni(1.0, d)), std::exp(between(-1.2, 2.5)));
    const PlantProfile assumed = sweepProfile(k, d, random() % 2 == 0 ? 0.0 : 0.05);
    PlantProfile real = assumed;
    real.delay_ticks += 2;
    const double push_N = between(0.4, 2.0), speed_mm_s = between(50.0, 400.0);
    cells[i] = {swingOf(assumed, real, hand, push_N, speed_mm_s, false),
                swingOf(assumed, real, hand, push_N, speed_mm_s, true)};
  });
  int swinging = 0, found = 0, latest_ms = 0;
  double left_mm = 0.0;
  for (const Cell& c : cells) {
    if (c.alone.way_mm < 10.0 * 0.055) continue;
    ++swinging;
    if (c.detects.alarm_tick < 0) continue;
    ++found;
    latest_ms = std::max(latest_ms, c.detects.alarm_tick);
    left_mm = std::max(left_mm, c.detects.way_mm);
  }
  to.report.require(
      "two ticks more than the profile states, 300 pushes at random: those that swing by more than "
      "ten "
      "counts and are found by the latency watch",
      "all, within 1 s",
      text("%d of %d, within %d ms; then at most %.2f mm", found, swinging, latest_ms, left_mm),
      found == swinging && latest_ms <= 1000);
}

/// The largest rise in a tick beyond K x the hand's way in it, where a tip at 330 mm/s meets the
/// wall.
void firstTouch(const StabilityReport& to) {
  double worst_N = 0.0;
  const auto touch = [&](ChainFixture& rig) {
    const Vec3 before_N = rig.out.force_N;
    const Vec3 before_mm = rig.device.truePosition_mm();
    rig.step();
    if (rig.out.force_N.norm() < before_N.norm()) return;
    const double way_mm = (rig.device.truePosition_mm() - before_mm).norm();
    worst_N = std::max(worst_N, (rig.out.force_N - before_N).norm() - rig.stiffness_N_mm * way_mm);
  };
  for (const double damping_Ns_m : {0.0, 1e9}) {
    for (const int d : {0, 1, 2, 3, 5}) {
      for (int sub = 0; sub < 10; ++sub) {
        const PlantProfile profile = sweepProfile(stiffnessLimit_N_mm(omni(1.0, d)), d);
        ChainFixture rig(profile, profile, Hand::none());
        rig.damping_Ns_m = damping_Ns_m;
        rig.wall_mm = 0.033 * sub;
        rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
        rig.run(250);
        rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -345.0});  // the device rubs
        while (rig.out.force_N.z() == 0.0) touch(rig);
        for (int i = 0; i < 10; ++i) touch(rig);
      }
    }
  }
  to.report.add(
      {"330 mm/s into K_max", "first_touch", "step beyond K x way", worst_N, "N", 0.0, true});
  to.report.require("first touch at 330 mm/s, K_max, any damping, d 0-5: step beyond K x the way",
                    "<= 0.3 N", text("%.2f N", worst_N), worst_N <= 0.3);
}

}  // namespace

void stabilityMoving(const StabilityReport& to) {
  inMotion(to);
  slowDevices(to);
  firstTouch(to);
}

}  // namespace hapticast::evaluate
