// SPDX-License-Identifier: MIT
#include "client/haptics/safety/oscillation_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
constexpr int kReversals = 12;
constexpr int kLongestSwing_ticks = 33;
constexpr double kLasting = 0.9;
constexpr int kBounces = 3;
constexpr int kShortestFlight_ticks = 15;  // a shorter flight only brushes the edge of the surface
constexpr int kLongestFlight_ticks = 250;
constexpr double kSlowestBounce_mm_s = 100.0;  // two counts per tick
}  // namespace

bool OscillationDetector::detectsAlarm(double moved_mm, double surface_mm, bool acts) noexcept {
  State& s = state_;
  s.idle_ticks = acts ? 0 : s.idle_ticks + 1;
  if (s.idle_ticks >= kLongestSwing_ticks) {
    s = State{};
    s.idle_ticks = kLongestSwing_ticks;
    return false;
  }
  s.now = {s.now.tip_mm + moved_mm, s.now.surface_mm + surface_mm, s.now.tick + 1};
  const double ahead_mm = s.direction * (s.now.tip_mm - s.extreme.tip_mm);
  if (ahead_mm > 0.0) s.extreme = s.now;
  if (ahead_mm > -least_swing_mm_) return false;
  judgeSwing();
  if (s.reversals < kReversals) return false;
  s = State{};
  return true;
}

/// Completes a swing: the HIP has returned from its extreme by the least swing.
void OscillationDetector::judgeSwing() noexcept {
  State& s = state_;
  const double swing_mm = std::abs(s.extreme.tip_mm - s.before.tip_mm);
  const double surface_mm = std::abs(s.extreme.surface_mm - s.before.surface_mm);
  const bool own = swing_mm >= least_swing_mm_ && surface_mm < 0.5 * swing_mm &&
                   s.extreme.tick - s.before.tick < kLongestSwing_ticks;
  const bool lasting = own && swing_mm >= kLasting * s.last_swing_mm;
  s.reversals = lasting ? s.reversals + 1 : own ? 1 : 0;
  s.last_swing_mm = own ? swing_mm : 0.0;
  s.direction = -s.direction;
  s.before = s.extreme;
  s.extreme = s.now;
}

/// Returns the number of bounces in a row including the completed contact; 0 if it was none.
int BounceDetector::countBounces() const noexcept {
  const State& s = state_;
  const bool bounced = s.acted && s.contact_ticks <= s.longest_ticks &&
                       s.in_mm_s >= kSlowestBounce_mm_s && s.out_mm_s >= kLasting * s.in_mm_s;
  const bool own = s.carried_mm_s < 0.5 * s.in_mm_s;
  const bool flew = s.free_ticks >= kShortestFlight_ticks && s.free_ticks <= kLongestFlight_ticks;
  return bounced && own && flew ? s.bounces + 1 : 0;
}

bool BounceDetector::detectsAlarm(const Tick& tick, int delay_ticks) noexcept {
  State& s = state_;
  if (tick.jump) s = State{};
  // The delay of the loop, plus two ticks beyond the declared delay.
  const int late_ticks = 3 + delay_ticks;
  if (tick.contact && s.free_ticks > 0) {
    s = State{.bounces = countBounces()};
    // 1.5 times half a period of the device on the spring.
    const double swing_ticks =
        1.5 * std::numbers::pi * std::sqrt(mass_kg_ / (1e3 * tick.stiffness_N_mm)) / kTick_s;
    s.longest_ticks =
        static_cast<int>(std::min(swing_ticks, double{kLongestFlight_ticks})) + 2 * late_ticks;
  }
  if (tick.contact) {
    s.normal = tick.normal;
    s.surface_mm_s = tick.surface_mm_s;
    s.carried_mm_s = std::max(s.carried_mm_s, std::abs(tick.normal.dot(tick.surface_mm_s)));
    s.acted = s.acted || tick.acts;
  }
  s.contact_ticks += tick.contact ? 1 : 0;
  s.free_ticks += tick.contact ? 0 : 1;
  const double out_mm_s = s.normal.dot(tick.tip_mm_s - s.surface_mm_s);
  if (tick.contact) s.in_mm_s = std::max(s.in_mm_s, -out_mm_s);
  if (s.free_ticks <= late_ticks) s.out_mm_s = std::max(s.out_mm_s, out_mm_s);
  if (s.bounces < kBounces) return false;
  s = State{};
  return true;
}

}  // namespace hapticast::client
