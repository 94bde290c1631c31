// SPDX-License-Identifier: MIT
// What the loop tells of every tick. A plain value that owns nothing.
#pragma once

#include <cstddef>
#include <cstdint>

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/playback/scene.hpp"
#include "client/haptics/safety/passivity_observer.hpp"
#include "client/haptics/safety/safety_action.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Why a fault was raised. The first one freezes the flight recorder.
enum class Fault : std::uint8_t {
  kNone = 0,
  kNotFinite,
  kDeviceLost,
  kLatency,
  kTooFar,     ///< a displacement, finite, that no device could make
  kTrustLost,  ///< the chain had too much to do about the stream
};
inline constexpr std::size_t kFaultKinds = 6;

/// Loop -> everybody, one per tick. Positions and penetration in nominal mm, forces in N in the
/// device frame.
struct TickReport {
  std::uint64_t tick = 0;
  LocalTime time;
  MediaTime play_time;
  Duration playout_delay{0};
  Duration tick_duration{0};  ///< the tick before this one
  Vec3 hip_mm = Vec3::Zero();
  Vec3 force_N = Vec3::Zero();  ///< what went to the device
  Vec3 static_force_N =
      Vec3::Zero();  ///< surface share, after its wall law, before the chain's limits
  Vec3 dynamic_force_N = Vec3::Zero();
  double penetration_mm = 0.0;     ///< |displacement|, 0 without contact
  Vec3 contact_mm = Vec3::Zero();  ///< where the tip should be, nominal; meant in contact only
  bool contact = false;
  Lookup lookup = Lookup::kEmpty;
  Fault fault = Fault::kNone;  ///< raised in this tick
  DeviceStatus device = DeviceStatus::kOk;
  std::uint32_t buttons = 0;  ///< of the device, as DeviceState has them
  bool enabled = true;        ///< the device's enabling button is held, or it has none
  Halt halt = Halt::kNone;    ///< why there is no force until UserControls::rearm
  SafetyAction trust_loss_cause =
      SafetyAction::kImplausible;   ///< where trust is lost: mostly for this
  double step_excess_N = 0.0;       ///< force step beyond what the chain allows (must be 0)
  std::uint32_t interferences = 0;  ///< bit per safety step that changed the force
  PortWork work;                    ///< of the force so far
  DeviceMapping mapping;            ///< nominal <-> device mm in this tick
  // The object nearest to the HIP, for the window and for scripted hands.
  bool object_present = false;
  std::uint32_t object_id = 0;
  Vec3 object_position_mm = Vec3::Zero();  ///< reference point at play time
  Vec3 object_velocity_mm_s = Vec3::Zero();
  Vec2 object_centre_mm =
      Vec2::Zero();  ///< a point well inside its mask (where its edge is farthest)
  double object_centre_height_mm = 0.0;  ///< surface height there
  bool over_object = false;              ///< the HIP is above (or in) the mask
  double height_at_hip_mm = 0.0;  ///< surface height under the HIP, 0 when not over an object
};

/// A device that was lost answers again, but the force waits for UserControls::rearm.
inline bool deviceIsBack(const TickReport& report) noexcept {
  return report.halt == Halt::kDeviceLost && report.device == DeviceStatus::kOk;
}

}  // namespace hapticast::client
