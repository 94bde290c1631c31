// SPDX-License-Identifier: MIT
// Report of one tick of the haptic loop. The log, the views and the flight recorder use it.
// Thread: the loop writes it; any thread reads a copy.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/playback/scene.hpp"
#include "client/haptics/safety/passivity_observer.hpp"
#include "client/haptics/safety/safety_action.hpp"
#include "client/haptics/safety/safety_state.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Cause of a fault. A fault freezes the flight recorder.
enum class Fault : std::uint8_t {
  kNone = 0,
  kNotFinite,
  kDeviceLost,
  kLatency,
  kTooFar,     ///< the displacement is longer than the reach of any device
  kTrustLost,  ///< too many safety actions due to the stream (safety/trust.hpp)
};
inline constexpr std::size_t kFaultKinds = 6;
/// Names of faults and lookups in logs, by their value.
inline constexpr std::array<const char*, kFaultKinds> kFaultNames = {
    "none", "not_finite", "device_lost", "latency", "displacement_too_large", "trust_lost"};
inline constexpr std::array<const char*, kLookupKinds> kLookupNames = {
    "none", "interpolated", "extrapolated", "held", "faded"};

/// What a tick read. With it, the frames and the settings, the tick can be rendered again (replay).
struct TickInputs {
  DeviceState reading;
  std::uint64_t frames = 0;    ///< number of frames that the loop has taken since the start
  std::uint64_t timing = 0;    ///< StreamTiming::number
  std::uint64_t controls = 0;  ///< UserControls::number
  bool stopping = false;       ///< HapticRenderer::stop() was called before the tick
};

/// The report of one tick. It owns no memory. Positions and penetration are in mm of the nominal
/// frame. Forces are in N, in the device frame.
struct TickReport {
  std::uint64_t tick = 0;
  LocalTime time;
  TickInputs inputs;
  MediaTime play_time;
  Duration playout_delay{0};
  Duration tick_duration{0};     ///< computing time of the tick before
  Vec3 hip_mm = Vec3::Zero();    ///< HIP as the device measured it
  Vec3 ahead_mm = Vec3::Zero();  ///< predicted HIP, to which contact and penetration belong
  Vec3 force_N = Vec3::Zero();   ///< force sent to the device
  /// Force of the surface by the wall law, before the limits of the safety chain.
  Vec3 static_force_N = Vec3::Zero();
  Vec3 dynamic_force_N = Vec3::Zero();
  double penetration_mm = 0.0;  ///< length of the displacement; 0 without contact
  /// Surface point that belongs to `ahead_mm`; valid only in contact.
  Vec3 contact_mm = Vec3::Zero();
  bool contact = false;
  Lookup lookup = Lookup::kEmpty;
  Fault fault = Fault::kNone;  ///< fault that began in this tick, if any
  DeviceStatus device = DeviceStatus::kOk;
  std::uint32_t buttons = 0;  ///< bits as in DeviceState
  bool enabled = true;        ///< the user holds the enabling button, or the device has none
  Halt halt = Halt::kNone;    ///< cause of the present halt, which lasts until UserControls::rearm
  SafetyAction trust_loss_cause =
      SafetyAction::kImplausible;  ///< most frequent of the safety actions that count against trust
  double trust_score_ticks = 0.0;  ///< counted safety actions of the stream (safety/trust.hpp)
  double step_excess_N = 0.0;      ///< step of the force beyond the slew limit; must be 0
  std::uint32_t safety_actions = 0;  ///< one bit for each safety action that changed the force
  /// One bit for each safety state (safety/safety_state.hpp) that holds.
  std::uint32_t safety_states = 0;
  PortWork work;          ///< work of the force since the start, by its cause
  DeviceMapping mapping;  ///< conversion between nominal and device mm in this tick
  // The object nearest to the HIP, for the window and for scripted hands.
  bool object_present = false;
  std::uint32_t object_id = 0;
  /// Position of the object's reference point at play time.
  Vec3 object_position_mm = Vec3::Zero();
  Vec3 object_velocity_mm_s = Vec3::Zero();
  /// Point of the object's mask that is farthest from the mask's edge.
  Vec2 object_centre_mm = Vec2::Zero();
  double object_centre_height_mm = 0.0;  ///< height of the surface at object_centre_mm
  /// True: in the picture, the HIP lies inside the object's mask.
  bool over_object = false;
  /// Height of the surface under the HIP; 0 if over_object is false.
  double height_at_hip_mm = 0.0;
};

/// Returns true if a device that was lost answers again, and the force still waits for
/// UserControls::rearm.
inline bool deviceIsBack(const TickReport& report) noexcept {
  return report.halt == Halt::kDeviceLost && report.device == DeviceStatus::kOk;
}

}  // namespace hapticast::client
