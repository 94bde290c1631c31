// SPDX-License-Identifier: MIT
// State machine of a Falcon: homing, plausibility of the replies, force ramp, lights and motors.
// Time is an argument; no heap.
// Thread: loop.
#pragma once

#include <cstdint>

#include "client/device/falcon/protocol.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Converts replies to device states, and forces to requests.
class FalconPilot {
 public:
  enum class Phase : std::uint8_t {
    kAway,     ///< no replies
    kHoming,   ///< red: the position is unknown until the grip has moved out and in
    kOutside,  ///< blue: homed, but the grip is not near the middle yet
    kReady,    ///< green: a force may act
  };
  // Chosen, all of them:
  static constexpr int kHomedReplies = 50;     ///< replies in a row until homing counts
  static constexpr int kMostMotor = 2000;      ///< counts: half of the drivers' limit
  static constexpr int kFastest_per_ms = 150;  ///< counts: 5 m/s, above any hand
  static constexpr int kMostDoubts = 20;       ///< implausible replies in a row before a new homing
  static constexpr double kMiddle_mm = 40.0;   ///< radius in which a force may begin
  static constexpr double kFarthest_mm = 90.0;  ///< beyond the reach of the grip
  static constexpr Duration kRamp{500'000'000};
  static constexpr Duration kSilent{20'000'000};  ///< then the motors receive zero

  /// `gain` is in counts/(N m).
  explicit FalconPilot(double gain) noexcept : gain_(gain) {}

  /// Processes a reply that arrived at `at`.
  void onReply(const FalconReply& reply, LocalTime at) noexcept;
  /// Invalidates the position: the connection was lost, or has returned.
  void lost() noexcept;
  /// Returns the state for the loop: kOk with a new position, kNoData without one, kLost after the
  /// first kReady.
  DeviceState state() noexcept;
  /// Returns the request for this tick, with the force `force_N`, a part of it, or zero.
  FalconRequest request(const Vec3& force_N, LocalTime now) noexcept;

  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  /// Number of replies with a position that no hand reaches in that time, or no arm at all.
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
  int forget_ = 0;  // remaining requests without the homing flag, which start a new homing
  bool must_forget_ = false;  // replies are void until the device reports an axis as not homed
  FalconReply last_;
  LocalTime accepted_{};
  LocalTime ramp_begin_{};
  Vec3 position_m_ = Vec3::Zero();
  std::uint8_t buttons_ = 0;
  std::uint64_t implausible_ = 0;
};

}  // namespace hapticast::client
