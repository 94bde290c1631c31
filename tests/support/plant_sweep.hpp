// SPDX-License-Identifier: MIT
// The sweep of tests for every wall: approach at 0.2 m/s, an impact, hold 1 N, press
// slowly to 2.5 N, hold, release. Then measure at rest, with and without a hand.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {

struct NamedHand {
  const char* name;
  Hand hand;
};
inline constexpr std::array<NamedHand, 5> kHands = {{{"light", Hand::light()},
                                                     {"light-grip", Hand::lightGrip()},
                                                     {"firm", Hand::firm()},
                                                     {"firm-grip", Hand::firmGrip()},
                                                     {"none", Hand::none()}}};

/// The sweep's device: Omni class with a clamp of 8 N (a stronger device's, so that it does not
/// hide swings) and motors that stay cold.
inline PlantProfile sweepProfile(double stiffness_N_mm, int delay_ticks, double friction_N = 0.0) {
  PlantProfile profile = omni(stiffness_N_mm, delay_ticks, friction_N);
  profile.peak_N = profile.continuous_N = 8.0;
  return profile;
}

struct SweepResult {
  double residual_mm = 0.0;  ///< worst peak-to-peak of the two holds
  double noise_N = 0.0;      ///< rms of the force about its mean in the holds
  double kept = 0.0;     ///< rendered stiffness: force over depth in the second hold, of K asked
  double work_mJ = 0.0;  ///< true work into the hand over the contact
  bool released = false;
  [[nodiscard]] double counts(double count_mm) const { return residual_mm / count_mm; }
};

class StaticRegionFilter {
 public:
  void add(const ChainFixture& rig) {
    const double z_mm = rig.device.truePosition_mm().z();
    low_mm_ = std::min(low_mm_, z_mm);
    high_mm_ = std::max(high_mm_, z_mm);
    const double force_N = rig.out.force_N.z();
    sum_N_ += force_N;
    square_N2_ += force_N * force_N;
    depth_mm_ += rig.wall_mm - z_mm;
    ++ticks_;
  }
  void into(SweepResult& result, double stiffness_N_mm) const {
    result.residual_mm = std::max(result.residual_mm, high_mm_ - low_mm_);
    const double mean_N = sum_N_ / ticks_;
    result.noise_N =
        std::max(result.noise_N, std::sqrt(std::max(0.0, square_N2_ / ticks_ - mean_N * mean_N)));
    result.kept = sum_N_ / depth_mm_ / stiffness_N_mm;
  }

 private:
  double low_mm_ = 1e9;
  double high_mm_ = -1e9;
  double sum_N_ = 0.0;
  double square_N2_ = 0.0;
  double depth_mm_ = 0.0;
  int ticks_ = 0;
};

/// `quick`: holds of a third of their length.
inline SweepResult sweepPlant(ChainFixture& rig, const Hand& hand, bool quick = false) {
  const bool free = hand.stiffness_N_m == 0.0;
  const double soft_mm = free ? 0.0 : 1e3 / hand.stiffness_N_m;
  const double stretch_mm = soft_mm + 1.0 / rig.renderedStiffness_N_mm();
  const int hold = quick ? 1000 : 3000;
  rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
  rig.run(250);
  if (free) rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -200.0});
  const auto want = [&](double force_N, double from_mm) {
    if (free)
      rig.device.setPush({0.0, 0.0, -force_N});
    else
      rig.device.setTarget({0.0, 0.0, std::min(from_mm, 20.0) - force_N * stretch_mm});
  };
  SweepResult result;
  const double before_mJ = rig.true_work_mJ;
  for (int i = 0; i < 100; ++i) {  // the impact
    if (!free) want(0.0, 20.0 - 0.2 * i);
    rig.step();
  }
  StaticRegionFilter first;
  for (int i = 0; i < hold; ++i) {
    want(std::min(1.0, i / 200.0), 0.0);
    rig.step();
    if (i >= hold * 2 / 3) first.add(rig);
  }
  for (int i = 0; i < 1500; ++i) {
    want(1.0 + i / 1000.0, 0.0);
    rig.step();
  }
  StaticRegionFilter second;
  for (int i = 0; i < hold * 2 / 3; ++i) {
    rig.step();
    if (i >= hold / 3) second.add(rig);
  }
  first.into(result, rig.stiffness_N_mm);
  second.into(result, rig.stiffness_N_mm);
  want(-0.5, 0.0);
  rig.run(500);
  result.work_mJ = rig.true_work_mJ - before_mJ;
  result.released = rig.out.force_N == Vec3(Vec3::Zero());
  return result;
}

}  // namespace hapticast::client
