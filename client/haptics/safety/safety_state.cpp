// SPDX-License-Identifier: MIT
#include "client/haptics/safety/safety_state.hpp"

#include <algorithm>

namespace hapticast::client {

namespace {
constexpr Duration kSample{100'000'000};
constexpr Duration kHold{10'000'000'000};  // chosen: long enough to be read
// Chosen: a busy machine is late in bursts, which are one state.
constexpr Duration kHoldLate{60'000'000'000};
// A longer gap restarts the estimate of the motion (HipEstimator).
constexpr Duration kVeryLate{20'000'000};
// Chosen: a few late ticks do not change the touch. Each one's share decays within 1 s.
constexpr double kMostLate = 5.0;
constexpr double kKeep = 1.0 - kTick_s / 1.0;
}  // namespace

double WorkMeter::onWork(double work_mJ, LocalTime now) noexcept {
  if (!sampled_) work_mJ_.fill(work_mJ);
  const double done_mJ = work_mJ - work_mJ_[next_];  // the oldest sample
  if (!sampled_ || now - sample_ >= kSample) {
    sampled_ = true;
    sample_ = now;
    work_mJ_[next_] = work_mJ;
    next_ = (next_ + 1) % kSamples;
  }
  return done_mJ;
}

bool SafetyStates::isLate(LocalTime now) noexcept {
  const Duration since = now - last_;
  const bool counts = running_ && since > kLateTick;
  running_ = true;
  last_ = now;
  late_ = late_ * kKeep + (counts ? 1.0 : 0.0);
  return late_ > kMostLate || (counts && since > kVeryLate);
}

void SafetyStates::hold(SafetyState state, bool holds, LocalTime now, Duration lasts) noexcept {
  LocalTime& until = until_[static_cast<std::size_t>(state)];
  if (holds) {
    states_ |= bit(state);
    until = now + lasts;
  } else if (now >= until) {
    states_ &= ~bit(state);
  }
}

std::uint32_t SafetyStates::update(LocalTime now, double work_mJ, Halt halt,
                                   bool acknowledged) noexcept {
  if (acknowledged) {
    states_ &= ~(bit(SafetyState::kMovesHand) | bit(SafetyState::kTrustLost));
    work_ = {};
  }
  if (work_.onWork(work_mJ, now) > kMovesHand_mJ) states_ |= bit(SafetyState::kMovesHand);
  if (halt == Halt::kTrustLost) states_ |= bit(SafetyState::kTrustLost);
  hold(SafetyState::kLateMachine, isLate(now), now, kHoldLate);
  hold(SafetyState::kForceOff, halt != Halt::kNone && halt != Halt::kStopped, now, kHold);
  return states_;
}

}  // namespace hapticast::client
