// SPDX-License-Identifier: MIT
// Interface of a haptic device, and the profile with the limits of a device class.
//
// Device frame: right-handed, x to the right, y up, z out of the screen towards the viewer. The
// origin is the centre of the device's workspace.
// Thread: each function states its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Constants of a device class. The defaults are an Omni class: mass, count, peak and continuous
/// force are from its data sheet. The other values are chosen or measured
/// (client/haptics/README.md, "Constants of the chain").
struct DeviceProfile {
  std::string name = "omni";
  double mass_kg = 0.045;  ///< apparent mass at the HIP; never overstate it
  /// Clamp of the force.
  double peak_N = 3.3;
  /// Force that the motors can hold for ever.
  double continuous_N = 0.88;
  double count_mm = 0.055;  ///< position quantum of the encoders
  /// Ticks between reading the position and the begin of the force, 0..5; never understate it.
  int delay_ticks = 1;
  /// Enabling button (dead-man's switch): bit of DeviceState::buttons. Force acts only while the
  /// user holds the button. nullopt: the device has no such button.
  std::optional<int> enable_button;
  /// Bits of the buttons that pause or resume play time, and that re-arm the force.
  std::optional<int> pause_button;
  std::optional<int> rearm_button;
  double stiffness_N_mm = 0.5;  ///< stiffness without an author's value
  double slew_rise_N_per_tick = 0.2;
  double slew_fall_N_per_tick = 0.5;
  double residue_N_per_tick = 0.1;  ///< release ramp: descent of a force without a cause
  double pulse_limit_N = 2.0;       ///< largest height of an impact pulse
  double tank_mJ = 15.0;            ///< energy tank: energy into the hand at once
  double tank_W = 0.2;              ///< energy tank: sustained power into the hand
  double thermal_s = 20.0;          ///< time constant of the motors' heat
  Vec3 workspace_mm = {160.0, 120.0, 70.0};
};

/// kNoData: no new position in this tick. kLost: the device does not answer any more.
enum class DeviceStatus : std::uint8_t { kOk = 0, kNoData = 1, kLost = 2 };

/// One reading of the device.
struct DeviceState {
  Vec3 position_mm = Vec3::Zero();  ///< device frame
  std::uint32_t buttons = 0;
  LocalTime time;  ///< time of the position
  DeviceStatus status = DeviceStatus::kOk;
};

/// Returns true if the user holds the enabling button, or if the profile has none.
inline bool enabled(const DeviceProfile& profile, const DeviceState& state) noexcept {
  return !profile.enable_button || (state.buttons >> *profile.enable_button & 1U) != 0;
}

/// Counters of a device with a request-reply protocol.
struct DeviceTraffic {
  std::uint64_t round_trips = 0;
  std::uint64_t misses = 0;   ///< ticks without a reply to their request
  std::uint64_t resyncs = 0;  ///< damaged replies
};

struct TickReport;

/// A haptic device. One object drives one device.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  /// The profile must be constant for the lifetime of the device.
  [[nodiscard]] virtual const DeviceProfile& profile() const noexcept = 0;
  /// Returns a description for the log, such as "virtual device (omni) in a hand that does: press".
  /// Thread: any.
  [[nodiscard]] virtual std::string description() const = 0;
  /// Blocks until the next tick is due, at the latest until about `deadline`. Thread: loop, outside
  /// the tick.
  virtual void waitForTick(LocalTime deadline) noexcept = 0;
  /// Sends `force_N` (device frame, finite) and returns the newest position. Does not block.
  /// Thread: loop.
  virtual DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept = 0;
  /// Sends the force of this tick before the next exchange(), which repeats it. A device may ignore
  /// the call. Does not block. Thread: loop.
  virtual void sendForceEarly(const Vec3& /*force_N*/) noexcept {}
  /// Runs the device's share of the main loop: about every 10 ms, and once after the last tick.
  /// Some libraries require calls in the main thread. Must not block. Thread: main.
  virtual void poll() {}
  /// Returns the next line for the user: an instruction or an event. nullopt: none. Thread: main.
  [[nodiscard]] virtual std::optional<std::string> nextMessage() { return std::nullopt; }
  /// Returns the counters of the protocol; nullopt for a device without one. Thread: any.
  [[nodiscard]] virtual std::optional<DeviceTraffic> traffic() const noexcept {
    return std::nullopt;
  }
};

}  // namespace hapticast::client
