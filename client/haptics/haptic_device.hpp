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

inline constexpr int kMostDelay_ticks = 5;  ///< longest delay at which the wall law was measured

/// Constants of a device class. The defaults are those of an Omni class. Its mass, count, peak and
/// continuous force are from the data sheet. The other values are choices or were measured
/// (client/haptics/safety/README.md, "Constants of the chain").
struct DeviceProfile {
  std::string name = "omni";
  /// Apparent mass of the device at the HIP; a profile must never overstate it.
  double mass_kg = 0.045;
  /// Largest force that the safety chain sends.
  double peak_N = 3.3;
  /// Force that the motors can exert without a time limit.
  double continuous_N = 0.88;
  double count_mm = 0.055;  ///< smallest change of the position that the encoders measure
  /// Delay: the number of ticks from the reading of a position to the begin of its force, 0..5. A
  /// profile must never understate it.
  int delay_ticks = 1;
  /// Bit number of the enabling button (dead-man's switch) in DeviceState::buttons. Forces act only
  /// while the user holds the button. nullopt: the device has no such button.
  std::optional<int> enable_button;
  /// Bit numbers of two buttons there. The first pauses or resumes play time. The second
  /// re-arms the force. nullopt: the device has no such button.
  std::optional<int> pause_button;
  std::optional<int> rearm_button;
  double stiffness_N_mm = 0.5;  ///< stiffness of a surface for which the author states none
  double slew_rise_N_per_tick = 0.2;
  double slew_fall_N_per_tick = 0.5;
  /// Release ramp: a force without a cause descends by this much per tick.
  double residue_N_per_tick = 0.1;
  double pulse_limit_N = 2.0;  ///< largest force of the pulse of an impact
  double tank_mJ = 15.0;  ///< energy tank: energy that the force may transfer into the hand at once
  double tank_W = 0.2;    ///< energy tank: power that refills the tank
  double thermal_s = 20.0;  ///< time constant of the motors' heat
  Vec3 workspace_mm = {160.0, 120.0, 70.0};
};

/// Status of a reading. kOk: the reading has a new position. kNoData: the device has no new
/// position in this tick. kLost: the device does not answer any more.
enum class DeviceStatus : std::uint8_t { kOk = 0, kNoData = 1, kLost = 2 };

/// One reading of the device.
struct DeviceState {
  Vec3 position_mm = Vec3::Zero();  ///< device frame
  std::uint32_t buttons = 0;
  LocalTime time;  ///< time when the position was measured
  DeviceStatus status = DeviceStatus::kOk;
};

/// Returns true if the user holds the enabling button, or if the profile has none.
inline bool enabled(const DeviceProfile& profile, const DeviceState& state) noexcept {
  return !profile.enable_button || (state.buttons >> *profile.enable_button & 1U) != 0;
}

/// Counters of a device that answers each request with a reply.
struct DeviceTraffic {
  std::uint64_t round_trips = 0;
  std::uint64_t misses = 0;     ///< number of ticks in which no reply to the request arrived
  std::uint64_t resyncs = 0;    ///< number of damaged replies
  std::uint64_t saturated = 0;  ///< ticks in which the motors could not exert the force
  std::uint64_t reduced = 0;    ///< ticks in which the helper process reduced the force
  std::uint64_t slow = 0;       ///< exchanges of the driver that lasted more than 0.5 ms
};

struct TickReport;

/// A haptic device. One object drives one device.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  /// Returns the profile of the device. It must not change during the lifetime of the device.
  [[nodiscard]] virtual const DeviceProfile& profile() const noexcept = 0;
  /// Returns a description for the log, such as "virtual device (omni) in a hand that does: press".
  /// Thread: any.
  [[nodiscard]] virtual std::string description() const = 0;
  /// Returns the name of the driver and, if it is known, the serial number of the device, such as
  /// "falcon FT0TEST1". Returns an empty text for a device without a driver (virtual, mouse,
  /// gamepad). Thread: any.
  [[nodiscard]] virtual std::string id() const { return ""; }
  /// Blocks until the next tick is due. A device that determines the times of the ticks itself may
  /// end the wait before `deadline`. Otherwise the wait ends at about `deadline`. Thread: loop,
  /// outside the tick.
  virtual void waitForTick(LocalTime deadline) noexcept = 0;
  /// Sends `force_N` (device frame, finite) to the device and returns the newest reading. `report`
  /// is the report of the tick before. Only a simulated hand uses it. The call does not block.
  /// Thread: loop.
  virtual DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept = 0;
  /// Sends `force_N`, the force of the tick that ends now. The next exchange() sends the same force
  /// again. So the device receives the force earlier. A device may ignore the call. The call does
  /// not block. Thread: loop.
  virtual void sendForceEarly(const Vec3& /*force_N*/) noexcept {}
  /// Runs the device's part of the main loop, because some libraries require calls in the main
  /// thread. The client calls it about every 10 ms, and once after the last tick. It must not
  /// block. Thread: main.
  virtual void poll() {}
  /// Returns the next line for the user: an instruction or an event. Returns nullopt if there is
  /// none. Thread: main.
  [[nodiscard]] virtual std::optional<std::string> nextMessage() { return std::nullopt; }
  /// Returns the counters of the device's protocol. Returns nullopt for a device without a
  /// protocol. Thread: any.
  [[nodiscard]] virtual std::optional<DeviceTraffic> traffic() const noexcept {
    return std::nullopt;
  }
};

}  // namespace hapticast::client
