// SPDX-License-Identifier: MIT
// The callback of OpenHaptics' thread: one frame of the device. It sets the newest force and reads
// the position. Without a command for 20 ms it sets zero.
// Thread: each function states its own.
#pragma once

#include <atomic>
#include <cstdint>

#include "client/device/helper/shared_page.hpp"
#include "client/device/touch/hd_functions.hpp"
#include "common/geometry.hpp"
#include "common/sync/latest_value.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// What the callback read in one frame.
struct ServoReading {
  std::uint64_t frames = 0;   ///< frames without an error of the device
  std::uint64_t faults = 0;   ///< frames with one
  std::uint64_t limited = 0;  ///< frames in which the library limited the force
  LocalTime time{};           ///< begin of the frame
  Vec3 position_mm = Vec3::Zero();
  std::uint32_t buttons = 0;
  unsigned error = 0;  ///< code of the last error; remains
  bool lost = false;   ///< the device does not answer
  bool calibrated = false;
};

class Servo {
 public:
  /// Runs frames of `device` from now on, with a force of zero. `functions` and `clock` must
  /// outlive it. Thread: main.
  Servo(const HdFunctions& functions, unsigned device, const Clock& clock);
  /// Ends the frames. Thread: main.
  ~Servo();
  Servo(const Servo&) = delete;
  Servo& operator=(const Servo&) = delete;

  /// Sets the force of the next frames. Thread: one, the loop's.
  void command(const Vec3& force_N) noexcept;
  /// Returns the newest reading. The reference is valid until the next call. Thread: one.
  [[nodiscard]] const ServoReading& read() noexcept { return reading_.load(); }
  /// Waits for the next frame, at most until `deadline`. Thread: one.
  void waitForFrame(LocalTime deadline) noexcept;
  /// Sets zero for the next frames until the next command(). Waits for a frame with it, at most
  /// 50 ms. Switches the motors off if there is none. Returns true if the device received zero.
  /// Thread: any.
  bool commandZero() noexcept;
  /// Switches the motors on or off, also while the maker's library calls no servo callback. Thread:
  /// any.
  void switchMotors(bool on) noexcept;
  /// Returns true if the motors are switched on. Thread: any.
  [[nodiscard]] bool motorsOn() const noexcept { return motors_on_; }

 private:
  struct Command {
    Vec3 force_N = Vec3::Zero();
    LocalTime time{};
  };

  static unsigned runFrame(void* servo) noexcept;
  void frame() noexcept;
  void calibrate() noexcept;
  void collectErrors() noexcept;

  const HdFunctions& functions_;
  const unsigned device_;
  const Clock& clock_;
  LatestValue<Command> command_;
  LatestValue<ServoReading> reading_;
  ServoReading next_;  // library's thread
  Doorbell frame_ended_;
  std::atomic<bool> quiet_{true};
  std::atomic<bool> lost_{false};  // as in next_
  std::atomic<bool> motors_on_{false};
  std::uint32_t seen_ = 0;  // waitForFrame()
  unsigned long callback_ = 0;
};

}  // namespace hapticast::client
