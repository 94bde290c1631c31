// SPDX-License-Identifier: MIT
// Minutes of random life in front of a wall: reaches and jabs, tremor,
// a drifting and bouncing surface at 25 frames/s, lost frames, seeks, stalls, clock jumps, late
// ticks, NaN bursts, an object of 100 g with pulses. Seeded.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {

struct LifeResult {
  double step_p999_N = 0.0;
  double burst_mJ = 0.0;  ///< most energy into the hand above an allowance of 0.2 W
  int jumps = 0;
  int nans = 0;
  int alarms = 0;
  Vec3 end = Vec3::Zero();  ///< position and force: to compare two lives bit for bit
};

class Life {
 public:
  Life(ChainFixture& rig, unsigned seed) : rig_(rig), random_(seed) {}

  LifeResult live(int seconds) {
    std::vector<float> steps_N;
    const auto end_ms = static_cast<std::int64_t>(seconds) * 1000;
    double allowed_mJ = 0.0;
    while (t_ms_ < end_ms) {
      hand();
      surface();
      faults();
      pulse();
      const int late_ms = lateness();
      t_ms_ += late_ms;
      const Vec3 before_N = rig_.out.force_N;
      const double before_mJ = rig_.true_work_mJ;
      rig_.step(Duration(1'000'000) * late_ms);
      result_.alarms += rig_.out.latency_alarm;
      steps_N.push_back(static_cast<float>((rig_.out.force_N - before_N).norm()));
      allowed_mJ = std::max(0.0, allowed_mJ + rig_.true_work_mJ - before_mJ - 0.2 * late_ms);
      result_.burst_mJ = std::max(result_.burst_mJ, allowed_mJ);
    }
    const auto at = steps_N.begin() + static_cast<std::ptrdiff_t>(0.999 * double(steps_N.size()));
    std::nth_element(steps_N.begin(), at, steps_N.end());
    result_.step_p999_N = static_cast<double>(*at);
    result_.end = rig_.device.truePosition_mm() + rig_.out.force_N;
    return result_;
  }

 private:
  bool chance(double p) { return std::uniform_real_distribution(0.0, 1.0)(random_) < p; }
  double between(double a, double b) { return std::uniform_real_distribution(a, b)(random_); }

  void hand() {
    if (t_ms_ >= next_goal_ms_) {
      next_goal_ms_ = t_ms_ + 500;
      goal_mm_ = {between(-20, 20), between(-20, 20), between(-12, 12)};
      speed_mm_ms_ = chance(0.02) ? 2.0 : between(0.05, 0.5);
    }
    const Vec3 way_mm = goal_mm_ - target_mm_;
    if (way_mm.norm() > 0.0) target_mm_ += way_mm * std::min(1.0, speed_mm_ms_ / way_mm.norm());
    const double tremor_mm = 0.3 * std::sin(0.0628 * static_cast<double>(t_ms_));
    rig_.device.setTarget(target_mm_ + Vec3(0.0, 0.0, tremor_mm));
  }
  void surface() {
    while (t_ms_ >= frame_ms_ + 40) {
      frame_ms_ += 40;
      from_mm_ = to_mm_;
      if (chance(0.9)) to_mm_ = std::clamp(to_mm_ + between(-2.0, 2.0), -8.0, 8.0);  // 10 % lost
    }
    if (chance(1e-4)) {  // seek
      to_mm_ = from_mm_ = between(-8, 20);
      rig_.epoch_jump = true;
      ++result_.jumps;
    }
    if (chance(5e-5)) {  // clock jump
      to_mm_ = from_mm_ = between(-8, 20);
      ++result_.jumps;
    }
    const double s = static_cast<double>(t_ms_ - frame_ms_) / 40.0;
    rig_.wall_mm = from_mm_ + (to_mm_ - from_mm_) * s * s * (3.0 - 2.0 * s);
    rig_.wall_velocity_mm_s = (to_mm_ - from_mm_) * 6.0 * s * (1.0 - s) / 0.04;
    object_N_ = 0.1 * (to_mm_ - from_mm_) * (6.0 - 12.0 * s) / (0.04 * 0.04) * 1e-3;
  }
  void faults() {
    if (stale_ms_ <= 0 && chance(1e-4)) stale_ms_ = static_cast<int>(between(200, 800));
    if (nan_ms_ <= 0 && chance(2e-4)) {
      nan_ms_ = static_cast<int>(between(1, 10));
      ++result_.nans;
    }
    rig_.touchable = stale_ms_ <= 0;
    rig_.nan_heights = nan_ms_ > 0;
    rig_.blind = nan_ms_ == 3;
    if (stale_ms_ > 0) --stale_ms_;
    if (nan_ms_ > 0) --nan_ms_;
  }
  void pulse() {
    if (pulse_ms_ <= 0 && chance(1e-3)) pulse_ms_ = 15;
    const double pulse_N = pulse_ms_ > 0 ? 2.0 * std::sin(M_PI * (pulse_ms_ - 0.5) / 15.0) : 0.0;
    if (pulse_ms_ > 0) --pulse_ms_;
    rig_.dynamic_N = {between(-0.02, 0.02), between(-0.02, 0.02), object_N_ + pulse_N};
  }
  int lateness() {
    if (!chance(1e-4)) return 1;
    return chance(0.3) ? 200 : static_cast<int>(between(2, 11));
  }

  ChainFixture& rig_;
  std::mt19937_64 random_;
  LifeResult result_;
  std::int64_t t_ms_ = 0;
  std::int64_t next_goal_ms_ = 0;
  std::int64_t frame_ms_ = 0;
  Vec3 target_mm_ = Vec3(0.0, 0.0, 10.0);
  Vec3 goal_mm_ = target_mm_;
  double speed_mm_ms_ = 0.2;
  double from_mm_ = 0.0;
  double to_mm_ = 0.0;
  double object_N_ = 0.0;
  int stale_ms_ = 0;
  int nan_ms_ = 0;
  int pulse_ms_ = 0;
};

}  // namespace hapticast::client
