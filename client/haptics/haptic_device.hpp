// SPDX-License-Identifier: MIT
// What the loop asks of a haptic device, and the profile that says what it can stand. Device frame:
// right-handed, x right, y up, z out of the screen towards the viewer, origin at the centre of the
// device's workspace.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Constants of a device class. Defaults: Omni class; mass, counts, peak and continuous force are
/// its data sheet's, the others are chosen and measured (README.md: the chain's constants).
struct DeviceProfile {
  std::string name = "omni";
  double mass_kg = 0.045;  ///< apparent mass at the tip; never over-state it
  double peak_N = 3.3;
  double continuous_N = 0.88;
  double count_mm = 0.055;  ///< position quantum
  /// Between reading the position and the start of the force; never under-state it.
  int delay_ticks = 1;
  /// Bit of DeviceState::buttons that has to be held for any force (a dead-man); none: no such
  /// button.
  std::optional<int> enable_button;
  /// Buttons that stop the picture's time (and let it go on), and that bring the force back.
  std::optional<int> pause_button;
  std::optional<int> rearm_button;
  double stiffness_N_mm = 0.5;  ///< default rendered stiffness
  double slew_rise_N_per_tick = 0.2;
  double slew_fall_N_per_tick = 0.5;
  double residue_N_per_tick = 0.1;  ///< how fast a force that lost its reason ramps down
  double pulse_limit_N = 2.0;       ///< height of an impact pulse at most
  double tank_mJ = 15.0;            ///< energy the force may give to the hand at once ...
  double tank_W = 0.2;              ///< ... and for good
  double thermal_s = 20.0;          ///< time constant of the motors' heat
  Vec3 workspace_mm = {160.0, 120.0, 70.0};
};

enum class DeviceStatus : std::uint8_t { kOk = 0, kNoData = 1, kLost = 2 };

struct DeviceState {
  Vec3 position_mm = Vec3::Zero();  ///< device frame
  std::uint32_t buttons = 0;
  LocalTime time;  ///< when the position was taken
  DeviceStatus status = DeviceStatus::kOk;
};

/// The device's enabling button is held, or it has none.
inline bool enabled(const DeviceProfile& profile, const DeviceState& state) noexcept {
  return !profile.enable_button || (state.buttons >> *profile.enable_button & 1U) != 0;
}

/// What a device that is asked and answers has counted.
struct DeviceTraffic {
  std::uint64_t round_trips = 0;
  std::uint64_t misses = 0;   ///< ticks that began without the answer of their request
  std::uint64_t resyncs = 0;  ///< answers that were damaged
};

struct TickReport;

class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  [[nodiscard]] virtual const DeviceProfile& profile() const noexcept = 0;
  /// What it is, for a line of the log: "virtual device (omni) in a hand that does: press". Thread:
  /// any.
  [[nodiscard]] virtual std::string description() const = 0;
  /// Blocks until the next tick is due, at the latest about `deadline`. Called outside the tick.
  /// Thread: loop.
  virtual void waitForTick(LocalTime deadline) noexcept = 0;
  /// Sends the force (N, device frame, finite) and returns the newest position. `report`: of the
  /// tick that computed the force, for a device that shows the tick or follows its workspace; a
  /// default report before the first tick. Does not block. Thread: loop.
  virtual DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept = 0;
  /// The force of this tick as soon as it is known, for a device that sends it before the next
  /// exchange(), which hands it over again. Non-blocking. Thread: loop.
  virtual void sendForceEarly(const Vec3& /*force_N*/) noexcept {}
  /// A share of each turn of the main thread, about every 10 ms, and one after the last tick: for
  /// what a library wants done there. It must not wait. Thread: main.
  virtual void poll() {}
  /// The next line for the user: what to do, what has happened. Thread: main.
  [[nodiscard]] virtual std::optional<std::string> nextMessage() { return std::nullopt; }
  /// None: nothing travels. Thread: any.
  [[nodiscard]] virtual std::optional<DeviceTraffic> traffic() const noexcept {
    return std::nullopt;
  }
};

}  // namespace hapticast::client
