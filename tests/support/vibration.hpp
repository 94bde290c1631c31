// SPDX-License-Identifier: MIT
// A press that has to be silent: an impact at 0.2 m/s, then a steady push; how much of the force
// lies above 50 Hz in its last second, and how far the tip still moves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/support/plant_sweep.hpp"

namespace hapticast::client {

/// Four poles above 50 Hz at 1 kHz (Butterworth).
class Above50Hz {
 public:
  double next(double x) {
    if (first_) offset_ = x;
    first_ = false;
    x -= offset_;
    for (std::size_t i = 0; i < 2; ++i) {
      const double w = std::tan(M_PI * 0.05);
      const double n = 1.0 / (1.0 + w / kQuality[i] + w * w);
      const double y = n * x + z_[i][0];
      z_[i][0] = -2.0 * n * x - 2.0 * (w * w - 1.0) * n * y + z_[i][1];
      z_[i][1] = n * x - (1.0 - w / kQuality[i] + w * w) * n * y;
      x = y;
    }
    return x;
  }

 private:
  static constexpr std::array<double, 2> kQuality = {0.54119610, 1.3065630};
  std::array<std::array<double, 2>, 2> z_{};
  double offset_ = 0.0;
  bool first_ = true;
};

/// Those of the sweep, a bare hand of 50 g held stiffly and loosely: seven with none.
inline const std::vector<NamedHand>& quietHands() {
  static const std::vector<NamedHand> all = {kHands[0],
                                             kHands[1],
                                             kHands[2],
                                             kHands[3],
                                             kHands[4],
                                             {"50 g", {0.05, 2.0, 200.0, 0.0, 0.0}},
                                             {"50 g loose", {0.05, 2.0, 200.0, 300.0, 1.0}}};
  return all;
}
/// Arms that hold the device rigidly: many times its mass.
inline const std::vector<NamedHand>& heavyArms() {
  static const std::vector<NamedHand> all = {{"0.3 kg 5", {0.3, 5.0, 200.0, 0.0, 0.0}},
                                             {"0.3 kg 10", {0.3, 10.0, 200.0, 0.0, 0.0}},
                                             {"0.5 kg 10", {0.5, 10.0, 300.0, 0.0, 0.0}},
                                             {"1 kg 10", {1.0, 10.0, 300.0, 0.0, 0.0}},
                                             {"1 kg 20", {1.0, 20.0, 300.0, 0.0, 0.0}}};
  return all;
}
/// Arms of 1 kg that grip the device so hard that it is a part of them, hardly damped.
inline const std::vector<NamedHand>& stiffGrips() {
  static const std::vector<NamedHand> all = {{"1 kg 2 kN/m", {1.0, 10.0, 300.0, 2000.0, 3.0}},
                                             {"1 kg 5 kN/m", {1.0, 10.0, 300.0, 5000.0, 3.0}}};
  return all;
}

struct Silence {
  double above_50Hz_N = 0.0;  ///< rms
  double residual_mm = 0.0;   ///< peak to peak of the tip
  double excess_N = 0.0;      ///< step beyond what the hand explains: must be 0
};

struct Press {
  double push_N = 1.0;
  double speed_mm_s = 200.0;
  double wall_mm = 0.0;  ///< where between two counts the wall lies
  int hold_ticks = 3000;
};

/// `assumed` is what the chain knows of the device, `real` the device.
inline Silence pressSteadily(const DeviceProfile& assumed, const PlantProfile& real,
                             const Hand& hand, const Press& press = {}) {
  ChainFixture rig(assumed, real, hand, {.oscillation_detector = false});
  rig.wall_mm = press.wall_mm;
  const bool free = hand.stiffness_N_m == 0.0;
  const double stretch_mm =
      (free ? 0.0 : 1e3 / hand.stiffness_N_m) + 1.0 / rig.renderedStiffness_N_mm();
  rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
  rig.run(250);
  if (free) rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -press.speed_mm_s});  // no jump
  const int approach = static_cast<int>(20e3 / press.speed_mm_s);
  for (int i = 0; i < approach; ++i) {
    rig.device.setPush({0.0, 0.0, free ? -press.push_N * std::min(1.0, i / 200.0) : 0.0});
    rig.device.setTarget({0.0, 0.0, 20.0 - 1e-3 * press.speed_mm_s * i});
    rig.step();
  }
  Above50Hz filter;
  Silence result;
  double low_mm = 1e9;
  double high_mm = -1e9;
  for (int i = 0; i < press.hold_ticks; ++i) {
    const double push_N = press.push_N * (free ? 1.0 : std::min(1.0, i / 200.0));
    rig.device.setPush({0.0, 0.0, free ? -push_N : 0.0});
    rig.device.setTarget({0.0, 0.0, -push_N * stretch_mm});
    rig.step();
    const double fast_N = filter.next(rig.out.force_N.z());
    if (i < press.hold_ticks - 1000) continue;
    result.above_50Hz_N += fast_N * fast_N / 1000.0;
    low_mm = std::min(low_mm, rig.device.truePosition_mm().z());
    high_mm = std::max(high_mm, rig.device.truePosition_mm().z());
  }
  result.above_50Hz_N = std::sqrt(result.above_50Hz_N);
  result.residual_mm = high_mm - low_mm;
  result.excess_N = rig.max_excess_N;
  return result;
}

}  // namespace hapticast::client
