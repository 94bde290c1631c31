// SPDX-License-Identifier: MIT
// Check of a device, with a free grip. A faulty driver can render another force than the commanded
// one, and a wrong profile makes walls unstable; only the motion of the grip shows both. The check
// pushes the free grip along each axis and back, with 0.3 N for 0.12 s, once in each direction. The
// motion must have the right sign and axis. A fit of the motion (motion_fit.hpp) gives moving mass
// and delay, and the smallest step of the readings gives the count.
// Thread: one, which runs the ticks of the device.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/device/motion_fit.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Recording of one push along an axis, with one sample for each millisecond.
struct PushRecord {
  std::vector<double> force_N;
  std::vector<Vec3> position_mm;
  double step_mm = 0.0;  ///< smallest step of the readings on any axis; infinity: no motion
};

/// Result of a check.
struct DeviceCheck {
  double mass_kg = 0.0;   ///< smallest moving mass of the three axes
  int delay_ticks = 0;    ///< median of the delays of all pushes
  double count_mm = 0.0;  ///< smallest step of the readings
  std::string fault;      ///< what does not fit, for the user; empty: the device passed
  /// What the client changes in the profile, for the user; empty: nothing.
  std::string note;
};

/// Judges the pushes against `profile`: record 2 i is the push along axis i in the positive
/// direction, record 2 i + 1 that in the negative direction. The device fails if a motion has a
/// wrong sign or axis, if an axis does not move, if its count is more than 1.5 times that of the
/// profile, if its mass is more than three times that of the profile (somebody holds the grip), or
/// if its delay is above kMostDelay_ticks.
DeviceCheck judgeDevice(const std::array<PushRecord, 6>& pushes, const DeviceProfile& profile);

/// Lowers the mass and raises the delay of `profile` to the values of a check that the device
/// passed, where the check measured less than 80 % of the mass, or a longer delay.
void applyCheck(const DeviceCheck& check, DeviceProfile& profile);

/// Runs the check. `log_line` receives the lines of the device. Returns nullopt if `stop` becomes
/// true. Throws std::runtime_error (one line) if the device is lost, if the grip does not come
/// to rest within a minute, or if the machine is too busy.
std::optional<DeviceCheck> checkDevice(HapticDevice& device, const Clock& clock,
                                       const std::atomic<bool>& stop,
                                       const std::function<void(const std::string&)>& log_line);

/// Stores the result for the device `id` and `profile` in the file `file`, in place of an earlier
/// result. With a fault, only removes the earlier result. Throws std::runtime_error (one line).
void storeCheck(const std::string& file, const std::string& id, const DeviceProfile& profile,
                const DeviceCheck& check);
/// Returns the mass and the delay that storeCheck() stored for the device `id` and `profile`.
/// Returns nullopt if the device was not checked, did not pass its last check, or was checked with
/// another mass or count in its profile.
std::optional<DeviceCheck> readCheck(const std::string& file, const std::string& id,
                                     const DeviceProfile& profile);

}  // namespace hapticast::client
