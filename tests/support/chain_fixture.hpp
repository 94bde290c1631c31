// SPDX-License-Identifier: MIT
// A bench for the chain under a virtual clock: virtual device, HIP motion and safety chain against
// a flat wall.
#pragma once

#include <array>
#include <cmath>
#include <functional>

#include "client/device/virtual/virtual_device.hpp"
#include "client/haptics/estimation/hip_estimator.hpp"
#include "client/haptics/safety/chain.hpp"
#include "client/haptics/tick_report.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::client {

inline PlantProfile omni(double stiffness_N_mm, int delay_ticks, double friction_N = 0.0) {
  PlantProfile profile;
  profile.stiffness_N_mm = stiffness_N_mm;
  profile.delay_ticks = delay_ticks;
  profile.friction_N = friction_N;
  return profile;
}

/// A wall facing +z at `wall_mm` (device frame). One step() is one tick: device, motion, chain (or
/// another law in its place).
class ChainFixture {
 public:
  ChainFixture(const DeviceProfile& assumed, const PlantProfile& real, const Hand& hand,
               const SafetyLinks& links = {})
      : device(real, hand, clock),
        motion(assumed),
        chain(assumed, links),
        logged_(assumed),
        real_delay_ticks_(real.delay_ticks) {
    stiffness_N_mm = assumed.stiffness_N_mm;
  }

  const SafetyOutput& step(Duration period = Duration(1'000'000)) {
    clock.advance(period);
    const Vec3 from_mm = device.truePosition_mm();
    const Vec3 from_mm_s = device.trueVelocity_mm_s();
    DeviceState state = device.exchange(out.force_N, {});
    work(from_mm, period);
    if (blind) state.position_mm.setConstant(std::nan(""));
    if (lost) state.status = DeviceStatus::kLost;
    motion.setDelay(chain.delayTicks());
    motion.sent(out.force_N, chain.wall_N_mm());
    const HipEstimate& hip = motion.update(state);
    SafetyInput input;
    input.position_mm = hip.position_mm;
    input.velocity_mm_s = hip.velocity_mm_s;
    input.measurement_jumped = hip.restarted;
    input.measurement_late = hip.late;
    input.device_lost = lost;
    input.ahead = hip.ahead;
    const double depth_mm = wall_mm - (by_counts ? hip.position_mm : hip.ahead.position_mm).z();
    input.contact = wall_present && depth_mm > 0.0;
    input.displacement_mm = input.contact ? Vec3(0.0, 0.0, depth_mm) : Vec3(Vec3::Zero());
    if (nan_heights) input.displacement_mm.setConstant(std::nan(""));
    input.surface_velocity_mm_s = {0.0, 0.0, wall_velocity_mm_s};
    input.scene_step_s = toSeconds(period);
    input.stiffness_N_mm = stiffness_N_mm;
    input.damping_Ns_m = damping_Ns_m;
    input.world_jumped = epoch_jump;
    input.in_contact = touchable;
    input.dynamic_N = dynamic_N;
    input.dynamic_valid = true;
    epoch_jump = false;
    const Vec3 before_N = out.force_N;
    out = law ? law(input) : chain.step(input);
    measure(before_N);
    measureTrueStep(before_N, from_mm, from_mm_s);
    return out;
  }
  [[nodiscard]] double renderedStiffness_N_mm() const {
    return std::min(stiffness_N_mm, stiffnessLimit_N_mm(logged_));
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) step();
  }

  ManualClock clock;
  VirtualDevice device;
  HipEstimator motion;
  SafetyChain chain;
  SafetyOutput out;
  std::function<SafetyOutput(const SafetyInput&)> law;  ///< empty: the chain
  bool by_counts = false;  ///< a law that knows no look-ahead touches the wall where the count is
  double wall_mm = 0.0;    ///< at the time of the predicted HIP, as the scene
  double wall_velocity_mm_s = 0.0;
  double stiffness_N_mm = 0.5;
  double damping_Ns_m = 0.0;
  bool wall_present = true;
  bool touchable = true;
  bool epoch_jump = false;
  bool nan_heights = false;
  bool blind = false;
  bool lost = false;
  Vec3 dynamic_N = Vec3::Zero();
  double true_work_mJ = 0.0;  ///< of the force that truly acted over the tip's true way
  // Over all ticks since the last clear().
  double max_excess_N = 0.0;       // by the chain's own meter
  double max_true_excess_N = 0.0;  // beyond what the true motion of the HIP explains
  double max_step_N = 0.0;
  double max_force_N = 0.0;
  bool finite = true;
  std::array<std::uint64_t, kSafetyActionNames.size()> safety_actions{};
  void clear() {
    max_excess_N = max_true_excess_N = max_step_N = max_force_N = 0.0;
    safety_actions.fill(0);
  }
  [[nodiscard]] std::uint64_t count(SafetyAction which) const {
    return safety_actions[static_cast<std::size_t>(which)];
  }

 private:
  /// The device lived through `period` with the forces sent before.
  void work(const Vec3& from_mm, Duration period) {
    for (Duration t{0}; t < period; t += Duration(1'000'000)) {
      for (std::size_t i = sent_N_.size() - 1; i > 0; --i) sent_N_[i] = sent_N_[i - 1];
      sent_N_[0] = out.force_N;
    }
    const Vec3& acted_N = sent_N_[static_cast<std::size_t>(real_delay_ticks_)];
    true_work_mJ += acted_N.dot(device.truePosition_mm() - from_mm);
  }
  /// Step of the force beyond K |dx| + B |dv| + S of the true HIP.
  void measureTrueStep(const Vec3& before_N, const Vec3& from_mm, const Vec3& from_mm_s) {
    const double k = renderedStiffness_N_mm();
    const double b_mm = wallDamping_Ns_m(k, logged_.mass_kg, stiffnessLimit_N_mm(logged_)) * 1e-3;
    const double hand_N = k * (device.truePosition_mm() - from_mm).norm() +
                          b_mm * (device.trueVelocity_mm_s() - from_mm_s).norm();
    const bool rises = out.force_N.squaredNorm() > before_N.squaredNorm();
    const double slew_N = rises ? logged_.slew_rise_N_per_tick : logged_.slew_fall_N_per_tick;
    const double excess_N = (out.force_N - before_N).norm() - hand_N - slew_N;
    max_true_excess_N = std::max(max_true_excess_N, excess_N);
  }
  static std::array<Vec3, VirtualDevice::kLongestDelay_ticks + 1> zeros() {
    std::array<Vec3, VirtualDevice::kLongestDelay_ticks + 1> all;
    all.fill(Vec3::Zero());
    return all;
  }
  void measure(const Vec3& before_N) {
    max_excess_N = std::max(max_excess_N, out.step_excess_N);
    max_step_N = std::max(max_step_N, (out.force_N - before_N).norm());
    max_force_N = std::max(max_force_N, out.force_N.norm());
    finite = finite && out.force_N.allFinite();
    for (std::size_t i = 0; i < safety_actions.size(); ++i) {
      safety_actions[i] += (out.safety_actions >> i) & 1U;
    }
  }

  DeviceProfile logged_;
  int real_delay_ticks_;
  std::array<Vec3, VirtualDevice::kLongestDelay_ticks + 1> sent_N_ = zeros();
};

}  // namespace hapticast::client
