// SPDX-License-Identifier: MIT
// What is known of a Falcon from its replies, and what it is told: homing, plausibility, ramp,
// lights, motors. Pure: time is an argument; no heap. Thread: loop.
#pragma once

#include <cstdint>

#include "client/device/falcon/protocol.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

class FalconPilot {
 public:
  enum class Phase : std::uint8_t {
    kAway,     ///< nothing is heard of it
    kHoming,   ///< red: it does not know where it is; out and in finds out
    kOutside,  ///< blue: homed, but the grip is not near the middle yet
    kReady,    ///< green
  };
  // Chosen, all of them:
  static constexpr int kHomedReplies = 50;      ///< so many in a row say that an axis is homed
  static constexpr int kMostMotor = 2000;       ///< counts: half of what the motors take
  static constexpr int kFastest_per_ms = 150;   ///< counts: 5 m/s; no hand is faster
  static constexpr int kMostDoubts = 20;        ///< replies in a row before it is homed anew
  static constexpr double kMiddle_mm = 40.0;    ///< radius in which a force may begin
  static constexpr double kFarthest_mm = 90.0;  ///< no grip gets there
  static constexpr Duration kRamp{500'000'000};
  static constexpr Duration kSilent{20'000'000};  ///< after it the motors are told zero

  /// `gain`: counts a N m.
  explicit FalconPilot(double gain) noexcept : gain_(gain) {}

  /// A reply that came at `at`.
  void onReply(const FalconReply& reply, LocalTime at) noexcept;
  /// The connection is lost, or there again: what was known of its position is void.
  void lost() noexcept;
  /// For the room: fresh, or no news, or lost since it was ready once.
  DeviceState state() noexcept;
  /// What it is told now: this force, or less or none.
  FalconRequest request(const Vec3& force_N, LocalTime now) noexcept;

  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  /// Replies whose position no hand could have reached in that time, or no arm at all.
  [[nodiscard]] std::uint64_t implausible() const noexcept { return implausible_; }

 private:
  void home(const FalconReply& reply, LocalTime at) noexcept;
  bool processReply(const FalconReply& reply, LocalTime at) noexcept;
  void rejectPosition() noexcept;
  [[nodiscard]] std::uint8_t lights() const noexcept;

  double gain_;
  Phase phase_ = Phase::kAway;
  bool was_ready_ = false;
  bool fresh_ = false;
  int homed_replies_ = 0;
  int rejected_ = 0;
  int forget_ = 0;            // requests still to go without the homing flag, so that it homes anew
  bool must_forget_ = false;  // its axes are not believed before they were without a mark
  FalconReply last_;
  LocalTime accepted_{};
  LocalTime ramp_begin_{};
  Vec3 position_m_ = Vec3::Zero();
  std::uint8_t buttons_ = 0;
  std::uint64_t implausible_ = 0;
};

}  // namespace hapticast::client
