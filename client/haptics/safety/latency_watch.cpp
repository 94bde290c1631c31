// SPDX-License-Identifier: MIT
#include "client/haptics/safety/latency_watch.hpp"

#include <cmath>

namespace hapticast::client {

namespace {
constexpr int kReversals = 8;
constexpr int kLongestSwing_ticks = 40;
constexpr double kLasting = 0.9;
}  // namespace

bool LatencyWatch::alarmed(double moved_mm, double surface_mm, bool acts) noexcept {
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

/// The tip has come back from its extreme by a swing's least: that swing is over.
void LatencyWatch::judgeSwing() noexcept {
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

}  // namespace hapticast::client
