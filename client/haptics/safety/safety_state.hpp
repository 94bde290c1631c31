// SPDX-License-Identifier: MIT
// Safety states: conditions of the run that the user must not miss. The window and the log show
// them, the summary lists them, and a device may have a light for them. No rate limiter applies: a
// state has an end of its own, so a stream cannot hide it behind other lines.
// Thread: loop, real-time (SafetyStates); any (the rest).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/safety/safety_action.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// A tick is late if it begins more than this after the tick before. Chosen: half a period late.
inline constexpr Duration kLateTick{1'500'000};

enum class SafetyState : std::uint8_t {
  /// The force did more than kMovesHand_mJ of work on the hand in 10 s. Lasts until the user
  /// re-arms the force.
  kMovesHand,
  kTrustLost,    ///< trust in the stream was lost. Lasts until the user re-arms the force.
  kLateMachine,  ///< the loop misses its milliseconds. Ends a minute after the last ones.
  kForceOff,     ///< a halt. Ends 10 s after the last halt.
};
inline constexpr std::size_t kSafetyStates = 4;
/// Name of each state in the summary, in the order of SafetyState.
inline constexpr std::array<const char*, kSafetyStates> kSafetyStateNames = {
    "moves_hand", "trust_lost", "late_machine", "force_off"};
/// Returns the bit of `state` in TickReport::safety_states.
constexpr std::uint32_t bit(SafetyState state) noexcept {
  return std::uint32_t{1} << static_cast<unsigned>(state);
}
/// Returns a line for the user.
constexpr const char* toText(SafetyState state) noexcept {
  switch (state) {
    case SafetyState::kMovesHand:
      return "this stream moves your hand: it did more than 100 mJ of work in 10 s";
    case SafetyState::kTrustLost:
      return "the client stopped the force, because it does not trust the stream";
    case SafetyState::kLateMachine:
      return "this machine is late: the loop misses its milliseconds; close other programs";
    case SafetyState::kForceOff:
      return "the force is off";
  }
  return "";
}

/// Measures the work of the force on the hand in the last 10 s.
class WorkMeter {
 public:
  /// Processes `work_mJ`, the work since the start of the run until `now`. Returns the work of the
  /// last 10 s, mJ.
  double onWork(double work_mJ, LocalTime now) noexcept;

 private:
  static constexpr std::size_t kSamples = 100;  // one every 100 ms
  std::array<double, kSamples> work_mJ_{};
  std::size_t next_ = 0;
  bool sampled_ = false;
  LocalTime sample_{};
};

/// Finds the states of each tick.
class SafetyStates {
 public:
  /// Above this work in 10 s, the stream moves the hand. Chosen between two values: a press only
  /// returns the work of the hand, and a ball that bounces on the hand at 1 m/s does 240 mJ.
  static constexpr double kMovesHand_mJ = 100.0;

  /// Returns the bits of the states after the tick at `now`. `work_mJ` is the work since the start,
  /// `halt` the present halt. `acknowledged` is true in the tick in which the user re-armed the
  /// force.
  std::uint32_t update(LocalTime now, double work_mJ, Halt halt, bool acknowledged) noexcept;

 private:
  [[nodiscard]] bool isLate(LocalTime now) noexcept;
  void hold(SafetyState state, bool holds, LocalTime now, Duration lasts) noexcept;

  WorkMeter work_;
  std::uint32_t states_ = 0;
  std::array<LocalTime, kSafetyStates> until_{};
  bool running_ = false;
  LocalTime last_{};
  double late_ = 0.0;  // late ticks, decaying
};

}  // namespace hapticast::client
