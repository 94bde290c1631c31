// SPDX-License-Identifier: MIT
// State machine of a Falcon. It controls the homing, rejects implausible replies, ramps the force,
// and computes the lights and the motor counts. Homing: the user moves the grip out and in, so that
// the device finds the zero of its encoders. Time is an argument. The functions use no heap.
// Thread: loop.
#pragma once

#include <cstdint>

#include "client/device/falcon/protocol.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Converts the replies of the device to readings for the loop, and forces to requests for the
/// device.
class FalconPilot {
 public:
  enum class Phase : std::uint8_t {
    kAway,     ///< no replies arrive
    kHoming,   ///< red light: the position is unknown until the grip has moved out and in
    kOutside,  ///< blue light: the position is known, but the grip has not been near the middle yet
    kReady,    ///< green light: a force may act
  };
  // All of these values are a choice:
  /// Replies in a row, with all axes homed, that complete the homing.
  static constexpr int kHomedReplies = 50;
  /// Largest motor counts: half of the value at which the motor drivers saturate.
  static constexpr int kMostMotor = 2000;
  /// Largest plausible change of an encoder in a ms, in counts. It corresponds to 5 m/s, which is
  /// faster than any hand.
  static constexpr int kFastest_per_ms = 150;
  static constexpr int kMostDoubts = 20;  ///< implausible replies in a row that cause a new homing
  /// Radius about the middle in which a force may begin.
  static constexpr double kMiddle_mm = 40.0;
  /// Largest plausible distance from the middle, beyond the reach of the grip.
  static constexpr double kFarthest_mm = 90.0;
  static constexpr Duration kRamp{500'000'000};
  /// After this time without a plausible reply the motors receive zero.
  static constexpr Duration kSilent{20'000'000};

  /// `gain` is the gain of the motors in counts/(N m).
  explicit FalconPilot(double gain) noexcept : gain_(gain) {}

  /// Processes one reply of the device, which arrived at the time `at`.
  void onReply(const FalconReply& reply, LocalTime at) noexcept;
  /// Marks the position as unknown. Call it when the connection was lost, and when it has returned.
  void onLost() noexcept;
  /// Returns the reading for the loop. In the phase kReady, its status is kOk with a new position,
  /// and kNoData without one. In another phase, its status is kLost if the device was ready before,
  /// else kNoData.
  DeviceState state() noexcept;
  /// Returns the request for this tick, which makes the motors exert `force_N`. During the ramp
  /// they exert a part of `force_N`. While no force may act, they exert zero.
  FalconRequest request(const Vec3& force_N, LocalTime now) noexcept;

  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  /// Returns the number of replies with an implausible position. Such a position is out of the
  /// arms' reach, or too far from the last one for the time between the two replies.
  [[nodiscard]] std::uint64_t implausible() const noexcept { return implausible_; }
  /// Makes the red light blink in place of the green one, or ends that.
  void warn(bool on) noexcept { warns_ = on; }
  /// Returns the number of requests for which the motors were scaled down to kMostMotor.
  [[nodiscard]] std::uint64_t saturated() const noexcept { return saturated_; }

 private:
  void home(const FalconReply& reply, LocalTime at) noexcept;
  bool processReply(const FalconReply& reply, LocalTime at) noexcept;
  void rejectPosition() noexcept;
  [[nodiscard]] std::uint8_t computeLights(LocalTime now) const noexcept;

  double gain_;
  Phase phase_ = Phase::kAway;
  bool was_ready_ = false;
  bool warns_ = false;  // the red light blinks
  bool fresh_ = false;
  int homed_replies_ = 0;
  int rejected_ = 0;
  std::int64_t gap_ms_ = 1;  // from the last accepted reply to the first one after it
  int forget_ = 0;           // remaining requests without the homing flag, which start a new homing
  bool must_forget_ = false;  // replies are ignored until the device reports an axis as not homed
  FalconReply last_;
  LocalTime accepted_{};
  LocalTime ramp_begin_{};
  Vec3 position_m_ = Vec3::Zero();
  std::uint8_t buttons_ = 0;
  std::uint64_t implausible_ = 0;
  std::uint64_t saturated_ = 0;
};

}  // namespace hapticast::client
