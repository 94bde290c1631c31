// SPDX-License-Identifier: MIT
// The servo callback. A thread of OpenHaptics calls it once in each frame (1 ms) of the device. It
// reads the position and sets the newest force. If the newest command is older than 20 ms, it sets
// zero force.
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

/// Reading of one frame. The counters count since the start.
struct ServoReading {
  std::uint64_t frames = 0;   ///< frames without an error of the device
  std::uint64_t faults = 0;   ///< frames with an error of the device
  std::uint64_t limited = 0;  ///< frames in which the library limited the force
  LocalTime time{};           ///< begin of the frame
  Vec3 position_mm = Vec3::Zero();
  std::uint32_t buttons = 0;
  unsigned error = 0;  ///< code of the last error since the start
  bool lost = false;   ///< the device does not answer
  bool calibrated = false;
};

class Servo {
 public:
  /// Switches the motors on and starts the callback for `device`, with a force of zero. `functions`
  /// and `clock` must outlive this object. Thread: main.
  Servo(const HdFunctions& functions, unsigned device, const Clock& clock);
  /// Commands zero, switches the motors off, and stops the callback. Thread: main.
  ~Servo();
  Servo(const Servo&) = delete;
  Servo& operator=(const Servo&) = delete;

  /// Sets the force of the next frames. Thread: one, the loop's.
  void command(const Vec3& force_N) noexcept;
  /// Returns the newest reading. The reference is valid until the next call. Thread: one.
  [[nodiscard]] const ServoReading& read() noexcept { return reading_.load(); }
  /// Waits for the next frame, at most until `deadline`. Thread: one.
  void waitForFrame(LocalTime deadline) noexcept;
  /// Sets zero force until the next command(). Waits at most 50 ms for a frame with that force, and
  /// switches the motors off if there is no such frame. Returns true if the device received zero.
  /// Thread: any.
  bool commandZero() noexcept;
  /// Switches the motors on or off, even if the library does not call the callback. Thread: any.
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
